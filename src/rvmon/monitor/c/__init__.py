"""Compiled C as a monitor: of streams, of columns."""
