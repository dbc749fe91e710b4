"""Formulas as monitors read them: hash-consed, in negation normal form, progressed."""
