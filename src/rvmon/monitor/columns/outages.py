"""When the signals of columns were not known: looked at where there is something to see."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Set
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.plan.outages import Outage, Outages
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.health import HealthKind
from rvmon.trace.time import TIME_LIMIT

if TYPE_CHECKING:
    from numpy.typing import NDArray


class ColumnOutages:
    """The outages of columns in which every row updates every signal.

    What becomes stale is read by no requirement that columns are asked for.
    """

    def __init__(self, spec: CheckedSpec, names: Set[str]) -> None:
        self._signals = sorted(names & spec.signals.keys())
        self._known = Outages(spec, names)
        self._seen: dict[str, list[Outage]] = {name: [one] for name, one in self._known.now.items()}

    def take(self, times: NDArray[np.int64], columns: Mapping[str, NDArray[Any]]) -> None:
        """Look through rows.

        Args:
            times: int64[n] ticks, later than all before.
            columns: by name, of the same length.
        """
        for name in self._signals:
            column = columns[name]
            lost = np.zeros(len(times), bool)
            if column.dtype.kind == "f":
                lost = np.isnan(column)
            turns = np.diff(lost, prepend=not lost[0])
            for row in np.flatnonzero(turns).tolist():
                self._row(name, int(times[row]), lost=bool(lost[row]))

    def at(self, t: int) -> Mapping[str, Outage]:
        """By name what was not known at an instant."""
        found = {}
        for name, seen in self._seen.items():
            place = bisect_right(seen, t, key=_since) - 1
            if place >= 0 and (seen[place].until is None or t < (seen[place].until or 0)):
                found[name] = seen[place]
        return found

    def _row(self, name: str, t: int, *, lost: bool) -> None:
        if not lost:
            self._known.found(name, t)
        elif name not in self._known.now:
            self._known.lost(name, t, HealthKind.NAN.value)
            self._seen.setdefault(name, []).append(self._known.now[name])


def _since(outage: Outage) -> int:
    """Before the first value, a signal was never known."""
    first = outage.why in (HealthKind.MISSING, HealthKind.ABSENT)
    return -TIME_LIMIT if first else outage.since
