"""What readers of columns give out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class NotPlainError(Exception):
    """The file has to be read row by row."""


@dataclass(frozen=True, slots=True)
class Block:
    """Some rows of a recording.

    Attributes:
        times: int64[n] ticks, strictly increasing, also from block to block.
        columns: by declared name: bool[n], int64[n] or float64[n].
    """

    times: NDArray[np.int64]
    columns: Mapping[str, NDArray[Any]]
