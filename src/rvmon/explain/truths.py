"""Where formulas are true over a whole recording, in spans of ticks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import assert_never

from rvmon.explain.spans import FOREVER, Spans, both, outside, union
from rvmon.formula.core import Core
from rvmon.formula.core_form import Lowering
from rvmon.formula.factory import Factory
from rvmon.monitor.core.watching import known_truths
from rvmon.plan.instances import occurrences_with
from rvmon.spec.checked.formula import Bound, BoundAtom, Formula
from rvmon.spec.checked.specification import CheckedSpec, ForEach, TimeModel
from rvmon.trace.sample import Payload, Sample, Scalar, Value


@dataclass(frozen=True, slots=True)
class Truth:
    """Where a formula is surely true, and where it may be (unknown or true), on all ticks."""

    sure: Spans
    may: Spans


def truths_of(
    spec: CheckedSpec,
    formulas: Sequence[Formula],
    samples: Sequence[Sample],
    end: int,
    names: frozenset[str] | None = None,
    *,
    for_each: ForEach | None = None,
    captured: Mapping[str, Scalar] | None = None,
) -> list[Truth]:
    """Where formulas are true in a recording; behind its end they may be anything.

    In held time all ticks are positions; else a truth lasts from its position to the next.

    Args:
        spec: the specification.
        formulas: may speak of the future.
        samples: the recording, in order; at least one.
        end: its last instant, ticks.
        names: the signals and events that have a source; `None`: all.
        for_each: of the instance that the formulas belong to, if they do to one.
        captured: the values of `let` and `for each`.
    """
    values = captured or {}
    lowering = Lowering(Factory(), spec.period, False)
    cores: dict[int, Core] = {
        place: lowering.core(formula, True)
        for place, formula in enumerate(formulas)
        if formula != BoundAtom(Bound.END)
    }
    seen = samples if for_each is None else _of_instance(for_each, values, samples)
    order = list(dict.fromkeys(cores.values()))
    found = dict(zip(order, known_truths(spec, order, seen, end, names, values), strict=True))
    ticks = _Ticks(spec, samples, end)
    made = {
        core: Truth(ticks.spans(one.true), ticks.others(one.false)) for core, one in found.items()
    }
    anything = Truth((), ticks.others(()))
    return [made[cores[place]] if place in cores else anything for place in range(len(formulas))]


def positions_of(spec: CheckedSpec, samples: Sequence[Sample], end: int) -> Sequence[int] | None:
    """The positions; `None` where every tick is one."""
    match spec.time:
        case TimeModel.HELD:
            return None
        case TimeModel.SAMPLED:
            return [sample.t for sample in samples]
        case TimeModel.CLOCKED:
            period = spec.period or 1
            return range(-(-samples[0].t // period) * period, end + 1, period)
        case _:
            assert_never(spec.time)


class _Ticks:
    """The ticks at which something is said of positions."""

    def __init__(self, spec: CheckedSpec, samples: Sequence[Sample], end: int) -> None:
        self._positions = positions_of(spec, samples, end)
        self._first = 0
        self._begin = samples[0].t
        if isinstance(self._positions, range):
            self._first = self._positions.start // self._positions.step
        self._end = end

    def spans(self, ranges: Iterable[tuple[int, int]]) -> Spans:
        """Those of ranges of positions."""
        whole = ((self._begin, self._end),)
        if self._positions is None:
            return both(union(ranges), whole)
        return both(union(self._lasting(ranges, self._positions)), whole)

    def others(self, ranges: Iterable[tuple[int, int]]) -> Spans:
        """All others, and those behind the end."""
        return outside(self.spans(ranges), self._begin, FOREVER)

    def _lasting(
        self, ranges: Iterable[tuple[int, int]], positions: Sequence[int]
    ) -> Iterator[tuple[int, int]]:
        last = len(positions) - 1
        for low, high in ranges:
            first, stop = max(low - self._first, 0), min(high - self._first, last)
            if first <= stop:
                yield positions[first], positions[stop + 1] - 1 if stop < last else self._end


def _of_instance(
    each: ForEach, captured: Mapping[str, Scalar], samples: Iterable[Sample]
) -> Iterator[Sample]:
    """A recording as the instance of a value sees it: other occurrences of its event are none."""
    event = each.value.event
    for sample in samples:
        if event not in sample.values:
            yield sample
            continue
        values: dict[str, Value] = {**sample.values}
        del values[event]
        seen = occurrences_with(each.value, captured[each.name], sample.values[event])
        if seen:
            values[event] = _reported(seen)
        yield Sample(sample.t, values)


def _reported(seen: Sequence[Payload | None]) -> Value:
    """Occurrences as a sample reports them: an unknown one beside others has unknown fields."""
    if all(one is None for one in seen):
        return None
    return tuple({} if one is None else one for one in seen)
