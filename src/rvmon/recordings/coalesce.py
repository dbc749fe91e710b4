"""Updates with equal stamps become one sample (SEMANTICS 1)."""

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
    """Signals that got two values at one stamp; the later one in source order was kept."""

    def __init__(self) -> None:
        self._seen: dict[str, tuple[int, int]] = {}

    def add(self, name: str, t: int, count: int = 1) -> None:
        """Count conflicts of signal `name`, the first of them at instant `t`."""
        before, first = self._seen.get(name, (0, t))
        self._seen[name] = (before + count, first)

    @property
    def seen(self) -> Mapping[str, tuple[int, int]]:
        """By signal how many there were, and the first's instant."""
        return self._seen

    def health(self) -> list[Health]:
        """One entry per signal, the earliest first, whether rows or columns were looked through."""
        return [
            Health(HealthKind.CONFLICT, name, count, first, remark="two values at one stamp")
            for first, name, count in sorted((t, name, n) for name, (n, t) in self._seen.items())
        ]


def coalesce(
    samples: Iterable[Sample], events: Container[str], conflicts: Conflicts
) -> Iterator[Sample]:
    """Merge neighbouring samples with equal stamps.

    Events are or-ed, payloads of one event are collected in a tuple; of a signal's values the
    last one is kept and two that differ are counted.

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
    """The updates of a sample, without NaN and null of signals for which these are none.

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
    """The values of a sample joined with those of a later one at its instant; see `coalesce`."""
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
    """Kleene's or of two reports of one event at one instant; payloads are kept, all of them.

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

_LEAST = 3  # stretches of unknown values; fewer are dropouts

_SCALARS = frozenset({bool, int, float, str})
"""The types whose values are all known but NaN, which differs from itself."""

_LONGEST = 4  # known values of a stretch, on average, at most


class Alternation(Struct):
    """Known and unknown values of a name."""

    known: int = 0
    unknown: int = 0
    stretches: int = 0
    was_unknown: bool = False

    def add(self, *, is_unknown: bool) -> None:
        """Take a value."""
        if is_unknown:
            self.unknown += 1
            self.stretches += not self.was_unknown
        else:
            self.known += 1
        self.was_unknown = is_unknown

    def add_known(self, count: int) -> None:
        """Take so many known values, one at least."""
        self.known += count
        self.was_unknown = False

    def add_all(self, unknown: NDArray[np.bool_]) -> None:
        """Take values in order: whether each is unknown; there is one."""
        count = int(unknown.sum())
        self.unknown += count
        self.known += len(unknown) - count
        self.stretches += int((unknown[1:] & ~unknown[:-1]).sum())
        self.stretches += bool(unknown[0]) and not self.was_unknown
        self.was_unknown = bool(unknown[-1])

    @property
    def is_merge(self) -> bool:
        """Whether at least half is unknown, and known values seldom follow each other."""
        return (
            self.stretches >= _LEAST
            and self.known <= self.unknown
            and 0 < self.known <= _LONGEST * self.stretches
        )


class Alternations:
    """The alternations of all names of a recording; payload fields are called `event.field`."""

    def __init__(self) -> None:
        self.found: dict[str, Alternation] = defaultdict(Alternation)

    def note(self, values: Mapping[str, Value]) -> None:
        """Look through a sample."""
        for name, value in values.items():
            if value.__class__ in _SCALARS and value == value:
                self.found[name].add_known(1)
            elif isinstance(value, Mapping):
                for field, scalar in value.items():
                    self.found[f"{name}.{field}"].add(is_unknown=is_unknown(scalar))
            elif not isinstance(value, tuple):
                self.found[name].add(is_unknown=is_unknown(value))

    def remarked(self, health: Iterable[Health]) -> tuple[Health, ...]:
        """The findings, with a remark at unknown values that look like a merge's."""
        return tuple(
            replace(one, remark=REMARK)
            if one.kind in (HealthKind.NAN, HealthKind.NONE)
            and (found := self.found.get(one.name)) is not None
            and found.is_merge
            else one
            for one in health
        )
