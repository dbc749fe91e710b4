"""Merging of updates with equal stamps into one sample, and findings about unknown values.

Source: SEMANTICS 1.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from msgspec import Struct

from rvmon.trace.sample import Health, HealthKind, Payload, Sample, Value
from rvmon.trace.schema import is_unknown

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Conflicts:
    """Signals with two values at one stamp, of which the later one in source order was kept."""

    def __init__(self) -> None:
        self._seen: dict[str, tuple[int, int]] = {}

    def add(self, name: str, t: int, count: int = 1) -> None:
        """Count conflicts of signal `name`, the first one at instant `t` (ticks)."""
        before, first = self._seen.get(name, (0, t))
        self._seen[name] = (before + count, first)

    @property
    def seen(self) -> Mapping[str, tuple[int, int]]:
        """By signal, the number of conflicts and the instant of the first one."""
        return self._seen

    def health(self) -> list[Health]:
        """One finding per signal, the earliest first, so that rows and columns report alike."""
        return [
            Health(HealthKind.CONFLICT, name, count, first, remark="two values at one stamp")
            for first, name, count in sorted((t, name, n) for name, (n, t) in self._seen.items())
        ]


def coalesce(
    samples: Iterable[Sample], events: Container[str], conflicts: Conflicts
) -> Iterator[Sample]:
    """Merge neighbouring samples with equal stamps.

    An event occurs if it occurs in one of them, and payloads of one event are collected in a tuple.
    A signal keeps its last value; differing values are counted as conflicts.

    >>> pair = [Sample(1, {"go": True, "v": 1.0}), Sample(1, {"go": False, "v": 2.0})]
    >>> [dict(sample.values) for sample in coalesce(pair, {"go"}, Conflicts())]
    [{'go': True, 'v': 2.0}]
    """
    pending: Sample | None = None
    for sample in samples:
        if pending is None:
            pending = sample
        elif sample.t == pending.t:
            pending = Sample(sample.t, merged(pending, sample.values, events, conflicts))
        else:
            yield pending
            pending = sample
    if pending is not None:
        yield pending


def updates_in(values: Mapping[str, Value], ignoring: frozenset[str]) -> Mapping[str, Value]:
    """The updates of a sample, without NaN and null of the signals in `ignoring`.

    >>> updates_in({"x": None, "y": float("nan"), "z": 1.0}, frozenset({"x", "z"}))
    {'y': nan, 'z': 1.0}
    """
    if not ignoring:
        return values
    return {
        name: value
        for name, value in values.items()
        if name not in ignoring or (value is not None and value == value)
    }


def merged(
    first: Sample, then: Mapping[str, Value], events: Container[str], conflicts: Conflicts
) -> dict[str, Value]:
    """The values of a sample merged with later ones of the same instant; see `coalesce`."""
    made = dict(first.values)
    for name, value in then.items():
        if name not in made:
            made[name] = value
        elif name in events:
            made[name] = either_occurred(made[name], value)
        else:
            if made[name] != value:
                conflicts.add(name, first.t)
            made[name] = value
    return made


def either_occurred(first: Value, second: Value) -> Value:
    """The Kleene disjunction of two reports of an event at one instant; all payloads are kept.

    >>> either_occurred({"id": 1}, {"id": 2})
    ({'id': 1}, {'id': 2})
    >>> either_occurred(None, False) is None
    True
    """
    payloads = _payloads(first) + _payloads(second)
    if payloads:
        return payloads if len(payloads) > 1 else payloads[0]
    if first is True or second is True:
        return True
    return None if first is None or second is None else False


def _payloads(value: Value) -> tuple[Payload, ...]:
    if isinstance(value, tuple):
        return value
    return (value,) if isinstance(value, Mapping) else ()


REMARK = (
    "alternates with values, as in a merge of topics; if it stands for no update, say so: "
    'nan="no update", rvmon run --nan no-update'
)
"""The remark on a name whose unknown values alternate with others."""

_LEAST = 3  # the fewest stretches of unknown values that look like a merge; fewer are dropouts

_SCALARS = frozenset({bool, int, float, str})
"""The types whose values are all known except NaN, which differs from itself."""

_LONGEST = 4  # the most known values per stretch of unknown ones that look like a merge, on average


class Alternation(Struct):
    """Counts of the known and unknown values of a name."""

    known: int = 0
    unknown: int = 0
    stretches: int = 0  # runs of unknown values without a known one between
    was_unknown: bool = False

    def add(self, *, is_unknown: bool) -> None:
        """Count a value."""
        if is_unknown:
            self.unknown += 1
            self.stretches += not self.was_unknown
        else:
            self.known += 1
        self.was_unknown = is_unknown

    def add_known(self, count: int) -> None:
        """Count known values in a row, at least one."""
        self.known += count
        self.was_unknown = False

    def add_all(self, unknown: NDArray[np.bool_]) -> None:
        """Count values in order, at least one; bool[n], whether each is unknown."""
        count = int(unknown.sum())
        self.unknown += count
        self.known += len(unknown) - count
        self.stretches += int((unknown[1:] & ~unknown[:-1]).sum())
        self.stretches += bool(unknown[0]) and not self.was_unknown
        self.was_unknown = bool(unknown[-1])

    @property
    def is_merge(self) -> bool:
        """Whether the values look like a merge of topics.

        They do if at least half are unknown and known values come in short runs.
        """
        return (
            self.stretches >= _LEAST
            and self.known <= self.unknown
            and 0 < self.known <= _LONGEST * self.stretches
        )


class Alternations:
    """The alternations of all names of a recording; payload fields are called `event.field`."""

    def __init__(self) -> None:
        self.by_name: dict[str, Alternation] = defaultdict(Alternation)

    def note(self, values: Mapping[str, Value]) -> None:
        """Count the values of a sample."""
        for name, value in values.items():
            if value.__class__ in _SCALARS and value == value:
                self.by_name[name].add_known(1)
            elif isinstance(value, Mapping):
                for field, scalar in value.items():
                    self.by_name[f"{name}.{field}"].add(is_unknown=is_unknown(scalar))
            elif not isinstance(value, tuple):
                self.by_name[name].add(is_unknown=is_unknown(value))

    def remarked(self, health: Iterable[Health]) -> tuple[Health, ...]:
        """The findings, with `REMARK` on unknown values that look like a merge of topics."""
        return tuple(
            replace(one, remark=REMARK)
            if one.kind in (HealthKind.NAN, HealthKind.NONE)
            and (found := self.by_name.get(one.name)) is not None
            and found.is_merge
            else one
            for one in health
        )
