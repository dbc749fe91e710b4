"""What the end of a trace makes of a residual, as tests of its clocks."""

from __future__ import annotations

from rvmon.formula.core import Release
from rvmon.formula.residual import NO_CLOCK, Residual

EndClause = tuple[tuple[int, int, bool], ...]
"""Clock (−1: none), least age, and whether the age is that at the end or as far as time came."""


def end_clauses(residual: Residual) -> tuple[EndClause, ...]:
    """When the end of a trace makes a residual true, whatever else is pending (SEMANTICS 3).

    A bounded `R` counts if its window is over as far as time has come, an unbounded one if its
    window has opened at the end; nothing else counts.
    """
    made = []
    for clause in residual:
        releases = [(node, clock) for node, clock in clause if isinstance(node, Release)]
        if len(releases) == len(clause):
            tests: list[tuple[int, int, bool]] = []
            for node, clock in releases:
                if node.high is not None:
                    tests.append((clock, node.high + 1, False))
                elif clock != NO_CLOCK and node.low:
                    tests.append((clock, node.low, True))
            made.append(tuple(sorted(tests)))
    return tuple(sorted(made))
