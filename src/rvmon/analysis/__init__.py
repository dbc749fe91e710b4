"""What a specification means and can never do, and why a verdict came out.

Before any run: vacuity, conflicts, shortest timelines, words and graphs. After one: the truth of
each part of an attempt, what came too late, how near a trigger came. And the pages of all codes.
"""
