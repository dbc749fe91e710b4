"""When the signals of columns were not known: looked at where there is something to see."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Set
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.dataflow.outages import Outage, note_found, note_lost, outages_at_first
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.health import HealthKind
from rvmon.trace.time import TIME_LIMIT

if TYPE_CHECKING:
    from numpy.typing import NDArray


class ColumnOutages:
    """The outages of columns in which every row updates every signal.

    Args:
        spec: declares the names.
        names: of the columns.
        stale: by signal the time after which it becomes stale by itself, ticks.
    """

    def __init__(self, spec: CheckedSpec, names: Set[str], stale: Mapping[str, int]) -> None:
        self._spec = spec
        self._stale = stale
        self._signals = sorted(names & spec.signals.keys())
        self._now = outages_at_first(spec, {*spec.signals, *spec.events} - names)
        self._seen: dict[str, list[Outage]] = {name: [one] for name, one in self._now.items()}
        self._last: int | None = None

    def take(self, times: NDArray[np.int64], columns: Mapping[str, NDArray[Any]]) -> None:
        """Look through rows.

        Args:
            times: int64[n] ticks, later than all before.
            columns: by name, of the same length.
        """
        self.pass_to(int(times[0]) - 1)
        for name in self._signals:
            column = columns[name]
            lost = np.zeros(len(times), bool)
            if column.dtype.kind == "f":
                lost = np.isnan(column)
            turns = np.diff(lost, prepend=not lost[0])
            late = np.zeros(len(times), bool)
            if name in self._stale:
                late[:-1] = np.diff(times) > self._stale[name] + 1
                turns |= late
                turns[1:] |= late[:-1]
            for row in np.flatnonzero(turns).tolist():
                self._row(name, int(times[row]), lost=bool(lost[row]))
                if late[row]:
                    self._expire(name, int(times[row]))
        self._last = int(times[-1])

    def pass_to(self, t: int) -> None:
        """Let time come to `t` without a row."""
        for name, bound in self._stale.items():
            if self._last is not None and self._last + bound + 1 <= t:
                self._expire(name, self._last)

    def at(self, t: int) -> Mapping[str, Outage]:
        """By name what was not known at an instant."""
        found = {}
        for name, seen in self._seen.items():
            place = bisect_right(seen, t, key=_since) - 1
            if place >= 0 and (seen[place].until is None or t < (seen[place].until or 0)):
                found[name] = seen[place]
        return found

    def _row(self, name: str, t: int, *, lost: bool) -> None:
        if lost:
            self._lose(name, HealthKind.NAN, t)
        else:
            note_found(self._now, name, t)

    def _expire(self, name: str, updated: int) -> None:
        self._lose(name, HealthKind.STALE, updated + self._stale[name] + 1)

    def _lose(self, name: str, why: HealthKind, t: int) -> None:
        if name not in self._now:
            note_lost(self._now, self._spec, name, why, t)
            self._seen.setdefault(name, []).append(self._now[name])


def _since(outage: Outage) -> int:
    """Before the first value, a signal was never known."""
    first = outage.why in (HealthKind.MISSING, HealthKind.ABSENT)
    return -TIME_LIMIT if first else outage.since
