"""Runs of a network: along a path with exact windows, in concrete times, or at random."""
