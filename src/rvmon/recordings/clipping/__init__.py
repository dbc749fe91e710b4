"""Pieces of recordings, in the recording's own format."""
