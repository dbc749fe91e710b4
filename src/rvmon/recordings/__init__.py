"""Recordings to samples: tables, JSON lines, bags and logs of messages, memory."""
