"""The rows of columns at which something changes, as samples."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import numpy as np

from rvmon.readers.blocks import Block
from rvmon.trace.sample import Sample


def changes(
    blocks: Iterable[Block], names: Collection[str], events: Collection[str], end: int
) -> list[Sample]:
    """The first row, and all at which a value is another than above or an event occurs.

    Args:
        blocks: of one recording, in order.
        names: the columns that are looked at; a sample holds no others.
        events: those that are events.
        end: the last instant that is looked at, ticks.

    >>> block = Block(np.array([1, 2, 3]), {"p": np.array([True, True, False])})
    >>> [(one.t, dict(one.values)) for one in changes([block], {"p"}, (), 9)]
    [(1, {'p': True}), (3, {'p': False})]
    """
    found: list[Sample] = []
    held: dict[str, object] = {}
    for block in blocks:
        count = int(block.times.searchsorted(end, "right"))
        columns = {name: block.columns[name][:count] for name in names if name in block.columns}
        differs = np.zeros(count, bool)
        differs[:1] = not found
        for name, column in columns.items():
            if name in events:
                differs |= column
                continue
            differs[1:] |= column[1:] != column[:-1]
            if count and column.item(0) != held.get(name):
                differs[0] = True
        rows = np.flatnonzero(differs)
        values = [column[rows].tolist() for column in columns.values()]
        for t, *row in zip(block.times[rows].tolist(), *values, strict=True):
            found.append(Sample(t, dict(zip(columns, row, strict=True))))
        if count < len(block.times):
            break
        held = {name: column.item(-1) for name, column in columns.items()}
    return found
