"""Analysis of specifications and of verdicts.

Before any run: vacuity, conflicts, shortest timelines, requirements in words and as graphs. After
one: the truth of each subformula of an attempt, late responses, near misses of triggers. And the
pages of all diagnostic codes.
"""
