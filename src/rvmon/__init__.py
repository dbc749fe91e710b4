"""Temporal requirements in, verdicts about robots out."""
