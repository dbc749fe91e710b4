"""Short runs, judged by the core, with what distinguishes situations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.core.plan import pack
from rvmon.explain.example import Example
from rvmon.monitor.compiled.code_plan import plan_alone
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.core.packed_cache import Kept
from rvmon.monitor.core.planned import planned_as
from rvmon.monitor.core.recorded import report_of_run
from rvmon.trace.sample import Sample

NEVER = (1 << 63) - 1
"""Later than any instant."""


@dataclass(frozen=True, slots=True)
class Played:
    """A short run, judged.

    Attributes:
        example: the run as it stands if it ends here.
        situation: equal for runs that go on alike, as far as the search looks.
        cut: the next instant after its end at which time alone may change something.
    """

    example: Example
    situation: bytes
    cut: int


class Player:
    """Judges short runs.

    Args:
        compiled: the specification.
        requirements: of it, those that are looked at.
    """

    def __init__(self, compiled: CompiledSpec, requirements: Sequence[CompiledRequirement]) -> None:
        self._ids = tuple(
            name
            for name in compiled.requirements
            if name in {one.requirement.id for one in requirements}
        )
        plan = plan_alone(compiled, self._ids, stepped=True)
        kept = Kept(pack(plan).data, frozenset(), {})
        self._planned = planned_as(compiled.checked, self._ids, kept, compiled)
        self._run = self._planned.monitor(frozenset())

    def play(self, samples: Sequence[Sample], end: int) -> Played:
        """Judge a short run.

        Args:
            samples: at least one.
            end: the instant at which the run ends, ticks, at or after the last sample.
        """
        run = self._run
        run.reset()
        for sample in samples:
            if not run.judge(sample.t, sample.values, False):
                values = self._planned.plain(sample.t, sample.values)
                if not run.judge(sample.t, values, True):
                    raise ValueError("the core does not take what the search has made up")
        situation, cut = run.situation(end)
        run.finish(end)
        report = report_of_run(self._planned, run, samples[0].t, end)
        example = Example(tuple(samples), end, report.verdicts, report.attempts)
        return Played(example, situation, NEVER if cut is None else cut)
