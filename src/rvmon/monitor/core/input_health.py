"""Input health of a run: what was not known, and why."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from struct import iter_unpack
from typing import TYPE_CHECKING, Any

from rvmon import native
from rvmon.monitor.inputs.intake import MOST_HELD, Intake
from rvmon.trace.health import Health, HealthKind
from rvmon.trace.sample import Value, payloads_of
from rvmon.trace.time import TIME_LIMIT, format_ticks

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.monitor.core.planned import PlannedCore
    from rvmon.readers.batch import Batch
    from rvmon.spec.checked.specification import CheckedSpec


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
        planned: PlannedCore,
        run: native.Monitor,
        absent: frozenset[str],
        first: Mapping[str, int | None],
        further: Iterable[Health] = (),
    ) -> tuple[Health, ...]:
        """All findings, by name with the requirements that read it.

        Args:
            planned: the plan of the requirements.
            run: is finished.
            absent: the names without a source.
            first: by signal, the instant of its first update, ticks; `None`: there was none.
            further: what was found elsewhere.
        """
        readers, names = planned.readers, list(planned.numbers)
        found = [
            Health(kind, shown, count, at, readers.get(name, ()))
            for (kind, shown, name), (count, at) in self._seen.items()
        ]
        for name, ids in readers.items():
            if name in absent:
                found.append(Health(HealthKind.ABSENT, name, 1, None, ids))
            elif name in first and self.began not in (None, first[name]):
                at = first[name]
                since = "no value" if at is None else f"first value at {format_ticks(at)}"
                found.append(Health(HealthKind.MISSING, name, 1, self.began, ids, remark=since))
        for number, count, at in run.stale():
            ids = readers.get(names[number], ())
            found.append(Health(HealthKind.STALE, names[number], count, at, ids))
        for one in further:
            ids = one.requirements or readers.get(one.name, ())
            found.append(replace(one, requirements=ids))
        return tuple(sorted(found, key=lambda entry: (entry.name, entry.kind)))


def of_intake(intake: Intake) -> list[Health]:
    """What was found of samples that were held back, whoever reads them."""
    found = intake.conflicts.health()
    if intake.crowded is not None:
        count, first = intake.crowded
        early = f"evaluated before the delay was over: {MOST_HELD:,} samples were waiting"
        found.append(Health(HealthKind.LATE, "buffer", count, first, remark=early))
    return found


class Findings:
    """Looks through what is judged.

    Args:
        checked: the specification.
        planned: the plan of the requirements.
        absent: the names without a source.
    """

    def __init__(self, checked: CheckedSpec, planned: PlannedCore, absent: frozenset[str]) -> None:
        self._log = HealthLog()
        self._planned = planned
        self._absent = absent
        signals = [name for name in planned.readers if name in checked.signals]
        self._first: dict[str, int | None] = dict.fromkeys(signals)
        self._to_come = set(signals) - absent

    def note_sample(self, t: int, values: Mapping[str, Value]) -> None:
        """Look through a sample."""
        self._log.note(t, values)
        for name in self._to_come & values.keys():
            self._come(name, t)

    def note_batch(self, batch: Batch) -> None:
        """Look through rows."""
        from rvmon.readers.batch_notes import unknown_rows

        times = batch.times
        if self._log.began is None:
            self._log.began = int(times[0])
        for name in self._to_come & batch.signals.keys():
            row = batch.signals[name].first_said
            if row is not None:
                self._come(name, int(times[row]))
        columns = dict(batch.signals)
        for event, one in batch.events.items():
            columns |= {f"{event}.{field}": cells for field, cells in one.fields.items()}
            self._log.add(HealthKind.NONE, event, event, one.unknown_at(times))
        for shown, cells in columns.items():
            is_signal = shown in batch.signals
            name = shown if is_signal else shown.rpartition(".")[0]
            for is_nan, at in unknown_rows(batch, cells, is_signal=is_signal):
                self._log.add(HealthKind.NAN if is_nan else HealthKind.NONE, shown, name, at)

    def _come(self, name: str, t: int) -> None:
        self._first[name] = t
        self._to_come.discard(name)

    def found(self, run: native.Monitor) -> tuple[Health, ...]:
        """All findings, once the run is finished."""
        return self._log.told(self._planned, run, self._absent, self._first)


def health_of_run(
    planned: PlannedCore, run: native.Monitor, absent: frozenset[str], further: Iterable[Health]
) -> tuple[Health, ...]:
    """The input health of a run that took samples.

    Args:
        planned: the plan of its requirements.
        run: is finished.
        absent: the names without a source.
        further: what was found of samples on their way.
    """
    log = HealthLog()
    log.began, _, _ = run.times()
    names = [(name, name) for name in planned.numbers]
    names += [(f"{event}.{field}", event) for event, field in planned.packed.fields]
    first: dict[str, int | None] = {}
    for (shown, name), found in zip(names, iter_unpack("=5q", run.arrivals()), strict=True):
        came, none_count, none_first, nan_count, nan_first = found
        if shown in planned.packed.signals:
            first[name] = None if came < -TIME_LIMIT else came
        log.add_count(HealthKind.NONE, shown, name, none_count, none_first)
        log.add_count(HealthKind.NAN, shown, name, nan_count, nan_first)
    return log.told(planned, run, absent, first, further)
