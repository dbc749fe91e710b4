"""Example timelines, and the default step between their samples."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from msgspec import Struct

from rvmon.language.checked.classify import subformulas
from rvmon.language.checked.formula import Binary, Unary
from rvmon.language.checked.specification import CheckedSpec, Requirement, TimeModel
from rvmon.trace.sample import Sample
from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt


class Example(Struct, frozen=True):
    """A short run with its verdicts."""

    samples: tuple[Sample, ...]  # in order of time
    end: int  # the end of the trace, ticks
    verdicts: Mapping[str, Verdict]  # by requirement
    attempts: Sequence[Attempt]


class Budget(Struct, frozen=True):
    """Limits of a search for examples."""

    runs: int = 4000  # the most runs judged
    samples: int = 6  # the most samples of one run
    # the default distance of two samples, ticks; `None`: see `small_step`
    step: int | None = None


class SearchResult(Struct, frozen=True):
    """The result of a search for examples."""

    # by kind, the example with the fewest samples; among these, the one that ends first
    examples: Mapping[str, Example]
    runs: int  # the number of runs judged
    exhausted: bool  # whether the whole search space was examined


def small_step(spec: CheckedSpec, requirements: Iterable[Requirement]) -> int:
    """A round number of ticks that is small relative to all durations of the requirements.

    In clocked time, a multiple of the period.
    """
    bounds = [
        bound
        for requirement in requirements
        for formula in (requirement.trigger, requirement.consequent)
        for part in subformulas(formula)
        if isinstance(part, Unary | Binary) and part.interval is not None
        for bound in (part.interval.low, part.interval.high)
        if bound
    ]
    bounds += [signal.stale_after for signal in spec.signals.values() if signal.stale_after]
    step = _rounded_down(min(bounds, default=2 * TICKS_PER_SECOND) // 2)
    if spec.time is TimeModel.CLOCKED and spec.period:
        return max(step // spec.period, 1) * spec.period
    return step


def _rounded_down(ticks: int) -> int:
    """The greatest of 1, 2, 5, 10, 20, … that is at most `ticks`, but at least 1."""
    scale = 1
    while scale * 10 <= ticks:
        scale *= 10
    return next((scale * digit for digit in (5, 2) if scale * digit <= ticks), scale)
