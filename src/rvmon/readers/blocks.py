"""What readers of columns give out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Block:
    """Some rows of a recording.

    Attributes:
        times: int64[n] ticks, strictly increasing, also from block to block.
        columns: by declared name: bool[n], int64[n] or float64[n].
    """

    times: NDArray[np.int64]
    columns: Mapping[str, NDArray[Any]]


def up_to(until: int | None, block: Block) -> Block:
    """The rows of a block up to an instant (ticks); all of them without one."""
    if until is None or not len(block.times) or block.times[-1] <= until:
        return block
    rows = int(block.times.searchsorted(until, "right"))
    return Block(block.times[:rows], {name: one[:rows] for name, one in block.columns.items()})
