"""A recording and a requirement become the tracks of a timeline."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from rvmon.readers.coalesce import updates_in
from rvmon.report.concerned import concerned_names, thresholds
from rvmon.report.tracks import Track, TrackKind
from rvmon.spec.checked.specification import CheckedSpec, Requirement, Signal
from rvmon.trace.health import Health, HealthKind
from rvmon.trace.sample import Sample, Scalar, Value
from rvmon.trace.schema import Kind

_KINDS = {
    Kind.BOOL: TrackKind.SWITCH,
    Kind.INT: TrackKind.NUMBER,
    Kind.REAL: TrackKind.NUMBER,
    Kind.LABEL: TrackKind.LABEL,
}


def tracks_of(
    spec: CheckedSpec,
    requirement: Requirement,
    samples: Sequence[Sample],
    health: Sequence[Health] = (),
) -> tuple[Track, ...]:
    """The tracks of the signals and events that a requirement reads, in its order."""
    updates = _updates(spec, samples, concerned_names(requirement))
    absent = {one.name for one in health if one.kind is HealthKind.ABSENT}
    return tuple(
        _signal_track(spec.signals[name], requirement, seen)
        if name in spec.signals
        else Track(name, TrackKind.EVENT, tuple(_occurrences(seen)), absent=name in absent)
        for name, seen in updates.items()
    )


def _updates(
    spec: CheckedSpec, samples: Iterable[Sample], names: Sequence[str]
) -> Mapping[str, list[tuple[int, Value]]]:
    updates: dict[str, list[tuple[int, Value]]] = {name: [] for name in names}
    for sample in samples:
        for name, value in updates_in(sample.values, spec.ignoring).items():
            if name in updates:
                updates[name].append((sample.t, value))
    return updates


def _occurrences(updates: Iterable[tuple[int, Value]]) -> Iterator[tuple[int, Scalar]]:
    for t, value in updates:
        if value is not False:
            yield t, None if value is None else True


def _signal_track(
    signal: Signal, requirement: Requirement, updates: Sequence[tuple[int, Value]]
) -> Track:
    changes: list[tuple[int, Scalar]] = []
    for index, (t, value) in enumerate(updates):
        known = _known(value)
        if not changes or changes[-1][1] != known:
            changes.append((t, known))
        if signal.stale_after is not None:
            stale_at = t + signal.stale_after + 1
            if known is not None and (
                index + 1 == len(updates) or updates[index + 1][0] > stale_at
            ):
                changes.append((stale_at, None))
    return Track(
        signal.name,
        _KINDS[signal.type.kind],
        tuple(changes),
        signal.type.unit,
        thresholds(requirement, signal.name),
    )


def _known(value: Value) -> Scalar:
    """A signal's value, `None` for what counts as unknown."""
    if isinstance(value, float) and value != value:  # NaN
        return None
    return value if isinstance(value, bool | int | float | str) else None
