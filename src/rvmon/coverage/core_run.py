"""Runs of the core of which somebody asks what they showed, and not what was decided."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from struct import iter_unpack
from typing import NamedTuple

import numpy as np

from rvmon.coverage.hits import Hit
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.core.monitor import CoreMonitor
from rvmon.monitor.core.planned import DECISIONS, VERDICTS, PlannedCore
from rvmon.monitor.core.recorded import RECORD
from rvmon.verdict.attempt import Attempt, Decision
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


class CoverageRun(CoreMonitor):
    """Takes samples as every monitor does, and makes no report."""

    def _conclude(self, t_ns: int | None) -> tuple[Report, Sequence[Attempt]]:
        end = self._core.finish(t_ns)
        self._note_times()
        return report_of((), (), end=end), ()


class RequirementRun(CoverageRun):
    """Judges requirements; the core notes where attempts went."""

    def __init__(
        self,
        planned: PlannedCore,
        compiled: CompiledSpec,
        settle: str,
        sources: frozenset[str] | None,
    ) -> None:
        super().__init__(planned, compiled, settle, sources)
        self._ids = planned.packed.ids

    def attempts(self) -> dict[str, list[Judged]]:
        """The attempts of each requirement, but those in doubt."""
        found: dict[str, list[Judged]] = {name: [] for name in self._ids}
        records = np.frombuffer(self._core.records()[0], RECORD)
        records = records[records["in_doubt"] == 0]
        columns = ("requirement", "triggered", "decided", "verdict", "decision")
        for number, triggered, decided, verdict, decision in zip(
            *(records[column].tolist() for column in columns), strict=True
        ):
            at = None if decision == _OPEN else decided
            found[self._ids[number]].append(Judged(triggered, at, VERDICTS[verdict]))
        return found

    def passages(self) -> dict[str, Passages]:
        """Where attempts of each requirement went in its automaton."""
        found: dict[str, Passages] = {}
        for number, name in enumerate(self._ids):
            locations, counted = self._core.passages(number)
            found[name] = {
                divmod(place, locations): Hit(count, first)
                for place, (count, first) in enumerate(iter_unpack("=qq", counted))
                if count
            }
        return found
