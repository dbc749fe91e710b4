"""Formulas as the engines read them: hash-consed, in negation normal form, progressed."""
