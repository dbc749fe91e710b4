"""Input health of a recording that the core judges: what was not known, and why."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from rvmon import native
from rvmon.monitor.inputs.health import Arrivals, HealthLog
from rvmon.trace.health import HealthKind
from rvmon.trace.sample import Value

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
        names = list(self._planned.numbers)
        expired = {names[number]: (count, first) for number, count, first in run.stale()}
        arrivals = Arrivals(self._absent, self._first, expired)
        return tuple(self._log.told(self._planned.readers, arrivals, None))
