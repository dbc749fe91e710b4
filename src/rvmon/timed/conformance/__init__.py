"""Recorded runs, held against a network."""
