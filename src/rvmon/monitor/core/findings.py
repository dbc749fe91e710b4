"""Input health of a recording that the core judges: what was not known, and why."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from struct import iter_unpack
from typing import TYPE_CHECKING

from rvmon import native
from rvmon.monitor.inputs.health import Arrivals, HealthLog
from rvmon.trace.health import HealthKind
from rvmon.trace.sample import Value
from rvmon.trace.time import TIME_LIMIT

if TYPE_CHECKING:
    from rvmon.monitor.core.planned import PlannedCore
    from rvmon.readers.batch import Batch
    from rvmon.spec.checked.specification import CheckedSpec
    from rvmon.trace.health import Health


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
        arrivals = Arrivals(self._absent, self._first, _expired(self._planned, run))
        return tuple(self._log.told(self._planned.readers, arrivals))


def _expired(planned: PlannedCore, run: native.Monitor) -> dict[str, tuple[int, int]]:
    names = list(planned.numbers)
    return {names[number]: (count, first) for number, count, first in run.stale()}


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
    arrivals = Arrivals(absent, first, _expired(planned, run))
    return tuple(log.told(planned.readers, arrivals, further))
