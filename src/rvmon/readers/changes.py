"""What changes in the columns of a recording, name by name."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.readers.blocks import Block
from rvmon.trace.sample import Sample

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Changes:
    """The rows at which a value is another than above or an event occurs, and the first row.

    Args:
        blocks: of one recording, in order; they are read once, whatever is asked for then.
        names: the columns that are looked at.
        events: those that are events.
        end: the last instant that is looked at, ticks.

    >>> block = Block(np.array([1, 2, 3]), {"p": np.array([True, True, False])})
    >>> changes = Changes([block], {"p"}, (), 9)
    >>> [(one.t, dict(one.values)) for one in changes.samples({"p"})]
    [(1, {'p': True}), (3, {'p': False})]
    """

    def __init__(
        self, blocks: Iterable[Block], names: Collection[str], events: Collection[str], end: int
    ) -> None:
        self._first: int | None = None
        self._found: dict[str, list[tuple[NDArray[np.int64], NDArray[Any]]]] = {}
        held: dict[str, object] = {}
        for block in blocks:
            count = int(block.times.searchsorted(end, "right"))
            times = block.times[:count]
            if self._first is None and count:
                self._first = times.item(0)
            for name in names & block.columns.keys():
                column = block.columns[name][:count]
                if not count:
                    continue
                if name in events:
                    differs = column
                else:
                    differs = np.append(True, column[1:] != column[:-1])
                    differs[0] = name not in held or column.item(0) != held[name]
                    held[name] = column.item(-1)
                rows = np.flatnonzero(differs)
                if len(rows):
                    self._found.setdefault(name, []).append((times[rows], column[rows]))
            if count < len(block.times):
                break

    def samples(self, names: Iterable[str]) -> list[Sample]:
        """The first row, and those at which one of some names changes; others are left out.

        Args:
            names: some of those that were looked at.

        Cost: grows with what is given, not with the recording.
        """
        if self._first is None:
            return []
        made: dict[int, dict[str, Any]] = {self._first: {}}
        for name in names:
            for times, values in self._found.get(name, ()):
                for t, value in zip(times.tolist(), values.tolist(), strict=True):
                    made.setdefault(t, {})[name] = value
        return [Sample(t, made[t]) for t in sorted(made)]
