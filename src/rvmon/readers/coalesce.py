"""Updates with equal stamps become one sample (SEMANTICS 1)."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping

from rvmon.trace.sample import Health, HealthKind, Payload, Sample, Value


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

    Args:
        samples: in source order.
        events: the names that are events; all others are signals.
        conflicts: where differing values are counted.

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
    """What a sample says, without NaN and null of signals of which these are no update.

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
    """What a sample says, and then another one of its instant; see `coalesce`."""
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
