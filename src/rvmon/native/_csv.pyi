"""The extension that reads CSV text; what its numbers mean stands in `csv.h`."""

from typing import Any

from numpy.typing import NDArray

source_hash: str

def read(
    text: bytes,
    start: int,
    is_last: bool,
    longest: int,
    slots: bytes,
    kinds: bytes,
    absent: bytes | None,
    numbers: NDArray[Any],
    says: NDArray[Any],
    lines: NDArray[Any],
    odd: NDArray[Any],
    labels: NDArray[Any],
    table: NDArray[Any],
    /,
) -> tuple[int, int, int, int, int, int, int]:
    """Read rows.

    Args:
        text: is read from `start` on.
        start: where a row begins.
        is_last: whether no text follows; else a row without end is left.
        longest: bytes of a cell.
        slots: int32 of each place in a row: its column, or -1.
        kinds: int32 of each column, the first of which is the stamp.
        absent: text that stands for no update.
        numbers: int64[columns, rows] or float64, to be filled.
        says: uint8[columns, rows], likewise.
        lines: int64[rows], on which each ends.
        odd: int64[n, 4], row, column, start and end of cells that are not read.
        labels: int64[n, 3], column, start and end of each.
        table: int32[2 n], zeros.

    Returns:
        How it ended; rows, where the next one begins and, if it is for Python, ends; lines, odd
        cells and labels.

    Raises:
        ValueError: the arrays do not fit together.
    """

def as_plain(text: bytes, separator: int, has_commas: int, /) -> bytes | None:
    """Write text with another separator as plain CSV of the same size.

    Args:
        text: some lines.
        separator: of cells, one byte.
        has_commas: whether numbers have commas, which become points.

    Returns:
        `None` if a line needs a closer look: a quote, a comma that stays, a row without a value.
    """

def rise(times: NDArray[Any], /) -> bool:
    """Whether each of these int64 is more than the one before."""
