"""Monitors of streams, in Python: a run from its first sample to its report or snapshot."""
