"""What columns have to be, and blocks of them one after the other, to be read without rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.readers.batch import NotPlainError
from rvmon.readers.blocks import Block
from rvmon.readers.csv_rows import Layout
from rvmon.trace.schema import Kind
from rvmon.trace.time import TIME_LIMIT

if TYPE_CHECKING:
    from numpy.typing import NDArray


def expect_plain_columns(layout: Layout) -> None:
    """See that all columns hold numbers and truth values.

    Raises:
        NotPlainError: one holds labels, or a field of a payload.
    """
    for column in layout.columns:
        if column.field is not None or column.kind is Kind.LABEL:
            raise NotPlainError(f"`{column.called}` holds no numbers or truth values")


class Seam:
    """What the rows before a block leave to it.

    Attributes:
        held: by signal its last value.
    """

    def __init__(self, layout: Layout) -> None:
        self.held: dict[str, Any] = {}
        self._signals = [column.name for column in layout.signals]
        self._last = -TIME_LIMIT

    def joined(self, block: Block) -> Block:
        """The block, which comes next.

        Raises:
            NotPlainError: it has no rows, or the instants do not increase.
        """
        times = block.times
        if len(times) and not -TIME_LIMIT < times[0] <= times[-1] < TIME_LIMIT:
            raise NotPlainError("some instant is out of range")
        if not len(times) or times[0] <= self._last or not (times[1:] > times[:-1]).all():
            raise NotPlainError("its instants do not increase")
        self._last = int(times[-1])
        self.held |= {name: block.columns[name][-1] for name in self._signals}
        return block


def held_values(some: NDArray[Any], given: NDArray[np.bool_], before: Any | None) -> NDArray[Any]:
    """A column of which gaps hold the value above them.

    Args:
        some: the values that are given, in order.
        given: bool[n], where there is one.
        before: the value above the first row; `None` if there is none.

    Raises:
        NotPlainError: there is no value for the first row, or some are NaN: in the gaps these would
            count as further ones.
    """
    if before is None and not given[:1].all():
        raise NotPlainError("a signal has no value in the first row")
    if before != before or (some.dtype.kind == "f" and np.isnan(some).any()):
        raise NotPlainError("NaN stands above gaps")
    first = np.array([] if before is None else [before], some.dtype if len(some) else None)
    filled: NDArray[Any] = np.concatenate((first, some))[np.cumsum(given) - 1 + len(first)]
    return filled
