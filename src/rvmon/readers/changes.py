"""What changes in the columns of a recording, name by name."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from collections.abc import Set as AbstractSet
from typing import Any

import numpy as np

from rvmon.readers.blocks import Block
from rvmon.trace.sample import Sample


class Changes:
    """The rows at which a value is another than above or an event occurs, and the first row.

    Args:
        blocks: of one recording, in order; they are read once, whatever is asked for then.
        names: the columns that are looked at.
        events: those that are events.
        end: the last instant that is looked at, ticks.

    Where a recording is not plain, `in_samples` looks at its samples instead.

    >>> block = Block(np.array([1, 2, 3]), {"p": np.array([True, True, False])})
    >>> changes = Changes([block], {"p"}, (), 9)
    >>> [(one.t, dict(one.values)) for one in changes.samples({"p"})]
    [(1, {'p': True}), (3, {'p': False})]
    """

    def __init__(
        self, blocks: Iterable[Block], names: AbstractSet[str], events: Collection[str], end: int
    ) -> None:
        self._first: int | None = None
        self._found: dict[str, list[tuple[list[int], list[Any]]]] = {}
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
                    found = times[rows].tolist(), column[rows].tolist()
                    self._found.setdefault(name, []).append(found)
            if count < len(block.times):
                break

    @classmethod
    def in_samples(
        cls, samples: Sequence[Sample], names: AbstractSet[str], events: Collection[str]
    ) -> Changes:
        """The samples that tell another value than the one before, or of an event.

        Args:
            samples: of one recording, in order.
            names: those that are looked at.
            events: those that are events.
        """
        made = cls((), names, events, 0)
        made._first = samples[0].t if samples else None
        held: dict[str, object] = {}
        for sample in samples:
            for name in names & sample.values.keys():
                value = sample.values[name]
                if name in events:
                    differs = value is not False
                else:
                    differs = name not in held or bool(value != held[name])
                    held[name] = value
                if differs:
                    ((times, values),) = made._found.setdefault(name, [([], [])])
                    times.append(sample.t)
                    values.append(value)
        return made

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
                for t, value in zip(times, values, strict=True):
                    made.setdefault(t, {})[name] = value
        return [Sample(t, made[t]) for t in sorted(made)]
