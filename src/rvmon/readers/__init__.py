"""Recordings on disk to samples: CSV and JSON lines."""
