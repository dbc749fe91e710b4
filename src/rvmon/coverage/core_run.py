"""Runs of the core of which somebody asks what they showed, and not what was decided."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from struct import iter_unpack
from typing import NamedTuple

import numpy as np

from rvmon import native
from rvmon.coverage.model import Hit
from rvmon.monitor.core.monitor import Monitor
from rvmon.monitor.core.planned import DECISIONS, VERDICTS
from rvmon.monitor.core.recorded import RECORD
from rvmon.verdict.attempt import Decision
from rvmon.verdict.report import Report, report_of
from rvmon.verdict.verdict import Verdict

Passages = Mapping[tuple[int, int], Hit]
"""From a location of an automaton to one; from the first to itself: attempts began."""

_OPEN = DECISIONS.index(Decision.OPEN)


class Judged(NamedTuple):
    """An attempt of which there surely was a trigger.

    Attributes:
        triggered: ticks.
        decided: the same; `None` if it was not.
        verdict: that it got.
    """

    triggered: int
    decided: int | None
    verdict: Verdict


class CoverageRun(Monitor):
    """Takes samples as every monitor does, and makes no report."""

    def _reported(self, end: int | None) -> Report:
        return report_of((), (), end=end)


def attempts_of(ids: Sequence[str], run: native.Monitor) -> dict[str, list[Judged]]:
    """The attempts of each requirement, but those in doubt."""
    found: dict[str, list[Judged]] = {name: [] for name in ids}
    records = np.frombuffer(run.records()[0], RECORD)
    records = records[records["in_doubt"] == 0]
    columns = ("requirement", "triggered", "decided", "verdict", "decision")
    for number, triggered, decided, verdict, decision in zip(
        *(records[column].tolist() for column in columns), strict=True
    ):
        at = None if decision == _OPEN else decided
        found[ids[number]].append(Judged(triggered, at, VERDICTS[verdict]))
    return found


def passages_of(ids: Sequence[str], run: native.Monitor) -> dict[str, Passages]:
    """Where attempts of each requirement went in its automaton; as `attempts_of`."""
    found: dict[str, Passages] = {}
    for number, name in enumerate(ids):
        locations, counted = run.passages(number)
        found[name] = {
            divmod(place, locations): Hit(count, first)
            for place, (count, first) in enumerate(iter_unpack("=qq", counted))
            if count
        }
    return found
