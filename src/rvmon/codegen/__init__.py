"""Monitors as source: generated Python and C99, with the runtimes that they stand on."""
