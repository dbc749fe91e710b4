"""Verdicts of many runs as a table: data for all renderers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from rvmon.verdict.verdict import Verdict

Counts = Mapping[Verdict, int]
"""How many runs got each of the four verdicts."""


@dataclass(frozen=True, slots=True)
class RunGroup:
    """Runs that are counted together, such as those of one test generation strategy.

    Attributes:
        name: heads the four columns.
        runs: how many there are.
        counts: by requirement; each sums to `runs`.
    """

    name: str
    runs: int
    counts: Mapping[str, Counts]


@dataclass(frozen=True, slots=True)
class VerdictTable:
    """Requirements down, groups of runs across, each with its counts of P, F, NT and I.

    Attributes:
        title: one line.
        requirements: id → text, in the order of the rows.
        groups: in the order of the columns.
        checked: what model checking says by requirement, `None` if it cannot be expressed;
            empty if nothing was checked.
        notes: remarks below the table.
        shows_intervals: whether each count comes with the interval of its share: that runs are
            drawn at random makes sense of it.
    """

    title: str
    requirements: Mapping[str, str]
    groups: tuple[RunGroup, ...]
    checked: Mapping[str, bool | None] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    shows_intervals: bool = False


def checked_text(holds: bool | None) -> str:
    """A result of model checking in the paper's letters: T, F, or – if not expressible."""
    return {True: "T", False: "F", None: "–"}[holds]
