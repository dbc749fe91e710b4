"""Input health of a run: what was not known, and why."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.inputs.intake import MOST_HELD, Intake
from rvmon.trace.health import Health, HealthKind
from rvmon.trace.sample import Value, payloads_of
from rvmon.trace.time import format_ticks

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Arrivals:
    """What was seen of signals and events in a run.

    Attributes:
        absent: the names without a source.
        first: by signal, the instant of its first update; `None`: there was none.
        expired: by signal how often it became stale, and the first instant of that.
    """

    absent: frozenset[str]
    first: Mapping[str, int | None]
    expired: Mapping[str, tuple[int, int]]


class HealthLog:
    """Counts unknown values as they come.

    Attributes:
        began: the instant of the first sample; `None` before it.
    """

    def __init__(self) -> None:
        self.began: int | None = None
        self._seen: dict[tuple[HealthKind, str, str], tuple[int, int]] = {}

    def note(self, t: int, values: Mapping[str, Value]) -> None:
        """Look through a sample that was taken."""
        if self.began is None:
            self.began = t
        for name, value in values.items():
            if value is None or value != value:
                self._add(name, name, value, t)
            elif type(value) is dict or type(value) is tuple:
                for payload in payloads_of(value):
                    for field, scalar in (payload or {}).items():
                        if scalar is None or scalar != scalar:
                            self._add(f"{name}.{field}", name, scalar, t)

    def add(self, kind: HealthKind, shown: str, name: str, times: NDArray[Any]) -> None:
        """Count unknown values at instants, in order, of a name that is shown so."""
        if len(times):
            count, first = self._seen.get((kind, shown, name), (0, int(times[0])))
            self._seen[kind, shown, name] = (count + len(times), first)

    def add_count(self, kind: HealthKind, shown: str, name: str, count: int, first: int) -> None:
        """Take so many unknown values that were counted, none being known before."""
        if count:
            self._seen[kind, shown, name] = (count, first)

    def _add(self, shown: str, name: str, value: object, t: int) -> None:
        key = (HealthKind.NONE if value is None else HealthKind.NAN, shown, name)
        count, first = self._seen.get(key, (0, t))
        self._seen[key] = (count + 1, first)

    def told(
        self,
        readers: Mapping[str, tuple[str, ...]],
        arrivals: Arrivals,
        further: Iterable[Health] = (),
    ) -> list[Health]:
        """All findings of the run, by name with the requirements that read it."""
        found = self._seen_by(readers)
        found += self._unfed(readers, arrivals)
        found += [
            Health(HealthKind.STALE, name, count, first, readers.get(name, ()))
            for name, (count, first) in arrivals.expired.items()
        ]
        found += [
            one if one.requirements else replace(one, requirements=readers.get(one.name, ()))
            for one in further
        ]
        return sorted(found, key=by_name)

    def _seen_by(self, readers: Mapping[str, tuple[str, ...]]) -> list[Health]:
        return [
            Health(kind, shown, count, first, readers.get(name, ()))
            for (kind, shown, name), (count, first) in self._seen.items()
        ]

    def _unfed(self, readers: Mapping[str, tuple[str, ...]], arrivals: Arrivals) -> list[Health]:
        """Names without a source, and signals that were unknown at first."""
        found = []
        for name, ids in readers.items():
            if name in arrivals.absent:
                found.append(Health(HealthKind.ABSENT, name, 1, None, ids))
            elif name in arrivals.first and self.began not in (None, arrivals.first[name]):
                first = arrivals.first[name]
                since = "no value" if first is None else f"first value at {format_ticks(first)}"
                found.append(Health(HealthKind.MISSING, name, 1, self.began, ids, remark=since))
        return found


def of_intake(intake: Intake) -> list[Health]:
    """What was found of samples that were held back, whoever reads them."""
    found = intake.conflicts.health()
    if intake.crowded is not None:
        count, first = intake.crowded
        early = f"evaluated before the delay was over: {MOST_HELD:,} samples were waiting"
        found.append(Health(HealthKind.LATE, "buffer", count, first, remark=early))
    return found


def by_name(entry: Health) -> tuple[str, HealthKind]:
    """The order of findings."""
    return entry.name, entry.kind


def readers_of(requirements: Sequence[CompiledRequirement]) -> dict[str, tuple[str, ...]]:
    """By name that is read, the ids of the requirements that do."""
    readers: dict[str, tuple[str, ...]] = {}
    for compiled in requirements:
        for name in compiled.reads:
            readers[name] = (*readers.get(name, ()), compiled.requirement.id)
    return readers
