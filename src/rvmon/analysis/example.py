"""Example timelines, and how their times are written."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from rvmon.spec.checked.classify import subformulas
from rvmon.spec.checked.formula import Binary, Formula, Interval, Unary
from rvmon.spec.checked.specification import CheckedSpec, Requirement, TimeModel
from rvmon.trace.sample import Sample
from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.verdict import Verdict
from rvmon.verdict.attempt import Attempt


@dataclass(frozen=True, slots=True)
class Example:
    """A short run and what the law says of it.

    Attributes:
        samples: what arrives, in order.
        end: the instant at which it ends, ticks.
        verdicts: by requirement.
        attempts: those that were started.
    """

    samples: tuple[Sample, ...]
    end: int
    verdicts: Mapping[str, Verdict]
    attempts: Sequence[Attempt]


@dataclass(frozen=True, slots=True)
class Budget:
    """How long to look for examples.

    Attributes:
        runs: short runs that are judged at most.
        samples: in one run at most.
        step: between two samples where nothing else asks for an instant, ticks; `None`: one that is
            small beside the durations of the requirements.
    """

    runs: int = 4000
    samples: int = 6
    step: int | None = None


@dataclass(frozen=True, slots=True)
class Found:
    """What a search for examples brought.

    Attributes:
        examples: by what was looked for, those with the fewest samples, then the earliest end.
        runs: how many were judged.
        exhausted: whether nothing was left to try among the instants and values looked at.
    """

    examples: Mapping[str, Example]
    runs: int
    exhausted: bool


def intervals_of(formula: Formula) -> Iterator[Interval]:
    """The intervals of a formula's operators."""
    for part in subformulas(formula):
        if isinstance(part, Unary | Binary) and part.interval is not None:
            yield part.interval


def small_step(spec: CheckedSpec, requirements: Iterable[Requirement]) -> int:
    """A step that is small beside all durations of some requirements, and a round number of ticks.

    Of a spec that is sampled by a clock, a whole number of its periods.
    """
    bounds = [
        bound
        for requirement in requirements
        for formula in (requirement.trigger, requirement.consequent)
        for interval in intervals_of(formula)
        for bound in (interval.low, interval.high)
        if bound
    ]
    bounds += [one.stale_after for one in spec.signals.values() if one.stale_after]
    step = _rounded_down(min(bounds, default=2 * TICKS_PER_SECOND) // 2)
    if spec.time is TimeModel.CLOCKED and spec.period:
        return max(step // spec.period, 1) * spec.period
    return step


def _rounded_down(ticks: int) -> int:
    """The greatest of 1, 2, 5, 10, … that is at most this, or 1."""
    scale = 1
    while scale * 10 <= ticks:
        scale *= 10
    return next((scale * digit for digit in (5, 2) if scale * digit <= ticks), scale)
