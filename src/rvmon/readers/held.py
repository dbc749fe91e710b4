"""Columns with gaps: what a signal holds where nothing was said of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.readers.blocks import NotPlainError

if TYPE_CHECKING:
    from numpy.typing import NDArray


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
