"""Monitors as source: generated Python and C99."""
