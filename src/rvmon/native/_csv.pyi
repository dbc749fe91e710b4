"""The extension that reads CSV text; `csv.h` explains its numbers."""

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
        text: the text, which is read from `start` on.
        start: where a row starts, in bytes.
        is_last: whether no text follows; if text follows, a row without an end is left unread.
        longest: the most bytes of a cell.
        slots: int32 for each place in a row: its column, or -1.
        kinds: int32 for each column, of which the first is the stamp.
        absent: the text that stands for no update; `None` if there is none.
        numbers: int64[columns, rows] or float64, to be filled.
        says: uint8[columns, rows], to be filled.
        lines: int64[rows], to be filled with the line on which each row ends.
        odd: int64[n, 4], to be filled with row, column, start and end of cells left to Python.
        labels: int64[n, 4], to be filled with column, start, end and sort of each label.
        table: int32[2 n], zeros; a hash table of labels.

    Returns:
        Why it ended (`csv_end`); the number of rows; where the next row starts and, if it is left
        to Python, where it ends; the numbers of lines, odd cells and labels.

    Raises:
        ValueError: the arrays do not fit together.
    """

def as_plain(text: bytes, separator: int, has_commas: int, /) -> bytes | None:
    """Write text with another separator as plain CSV of the same size.

    Args:
        text: some lines.
        separator: the separator of cells, one byte.
        has_commas: whether numbers have decimal commas, which become points.

    Returns:
        `None` if Python has to read a line: it has a quote, a comma that stays, or no value.
    """

def rise(times: NDArray[Any], /) -> bool:
    """Whether these int64 are strictly ascending."""
