"""The statements of the robot's code by state, and which of them have run: data and sums."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rvmon.report.percent import percent


@dataclass(frozen=True, slots=True)
class Statements:
    """The statements of the robot's code.

    Attributes:
        path: of the source file.
        by_state: lines of the statements of each state, in the order of a handover; `common`
            for what several states share.
    """

    path: str
    by_state: Mapping[str, frozenset[int]]


@dataclass(frozen=True, slots=True)
class StatementCoverage:
    """How many statements have run.

    Attributes:
        statements: how many there are.
        covered: how many of them have run.
        missing: lines of those that have not.
    """

    statements: int
    covered: int
    missing: tuple[int, ...]

    @property
    def percent(self) -> float:
        """The share of `covered`; 0 and 100 only where exactly none or all have run."""
        return percent(self.covered, self.statements)


def coverage_by_state(
    statements: Statements, executed: frozenset[int]
) -> dict[str, StatementCoverage]:
    """Hold the executed lines against the statements of each state."""
    return {state: _coverage(lines, executed) for state, lines in statements.by_state.items()}


def total_coverage(statements: Statements, executed: frozenset[int]) -> StatementCoverage:
    """Hold the executed lines against all statements."""
    return _coverage(frozenset().union(*statements.by_state.values()), executed)


def _coverage(lines: frozenset[int], executed: frozenset[int]) -> StatementCoverage:
    missing = lines - executed
    return StatementCoverage(len(lines), len(lines) - len(missing), tuple(sorted(missing)))
