"""Analysis of specifications and of verdicts.

Before any run: vacuity, conflicts, shortest example timelines, requirements in words and as graphs.
After a run: the truth of each subformula of an attempt, late responses, near misses of triggers.
The package also has the pages of all diagnostic codes.
"""
