"""Truth values, the locations of a decided attempt, and what stands for no instant."""

FALSE, UNKNOWN, TRUE = 0, 1, 2
"""Kleene's truth values: `and` is the minimum, `or` the maximum, `not` is 2 − x."""

FAILED, PASSED = 0, 1
"""The locations in which an attempt is decided; they stand first in every machine."""

NOW = -1
"""As the source of a clock: it is started at the position of the step."""

NEVER = 1 << 63
"""Later than any instant."""
