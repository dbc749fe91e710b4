"""Formulas as text, and the canonical layout of a file."""
