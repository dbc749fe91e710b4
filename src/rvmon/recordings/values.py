"""Text and JSON values to the values that a declared kind takes."""

from __future__ import annotations

import sys
from contextlib import suppress
from math import isinf
from typing import Any, assert_never

from rvmon.errors import TraceError
from rvmon.texts import shorten
from rvmon.trace.sample import Scalar
from rvmon.trace.schema import Kind
from rvmon.trace.stamps import is_whole

TRUE_WORDS = frozenset({"true", "True", "TRUE", "1"})
FALSE_WORDS = frozenset({"false", "False", "FALSE", "0"})

_ABSENT = frozenset({"na", "n/a", "<na>", "none", "null", "nil"})
"""The texts that programs write for a missing value: unknown, or no update."""


def scalar_of_text(text: str, kind: Kind) -> Scalar:
    """Read a cell, which is not empty; `nan` (any case) reads as NaN, but for labels.

    >>> [scalar_of_text("1.0", kind) for kind in (Kind.BOOL, Kind.INT, Kind.REAL, Kind.LABEL)]
    [True, 1, 1.0, '1.0']
    """
    match kind:
        case Kind.BOOL:
            if text in TRUE_WORDS:
                return True
            if text in FALSE_WORDS:
                return False
        case Kind.INT | Kind.REAL:
            # Python reads 1_000 as a number; no recording means it.
            try:
                if "_" not in text:
                    return _whole_of(text) if kind is Kind.INT else double_of(text)
            except TraceError:
                raise
            except ValueError:  # it may be NaN
                pass
            if kind is Kind.INT and is_whole(text):
                most = sys.get_int_max_str_digits()
                raise TraceError(f"`{shorten(text)}` has more than {most} digits: is it a number?")
        case Kind.LABEL:
            return text
        case _:
            assert_never(kind)
    with suppress(ValueError):
        number = float(text.replace("_", "?"))
        made = as_declared(number, kind)
        if made is None:
            return number
        if fits(made, kind):
            return made  # type: ignore[no-any-return]  # it fits
    is_absent = text.strip().lower() in _ABSENT
    hint = ": leave a cell without a value empty, or write NaN where it is unknown"
    raise TraceError(f"`{shorten(text)}` is not {DESCRIPTION[kind]}{hint if is_absent else ''}")


def _whole_of(text: str) -> int:
    number = int(text)
    if -_LARGEST <= number < _LARGEST:
        return number
    raise TraceError(f"`{shorten(text)}` is too large for a whole number: 64 bits hold it no more")


def double_of(text: str) -> float:
    """A number as a double; infinite only if it is called so.

    Raises:
        ValueError: the text is no number.
        TraceError: it is a number that is too large.

    >>> double_of("2.5"), double_of("-inf")
    (2.5, -inf)
    """
    number = float(text)
    if isinf(number) and any(map(str.isdigit, text)):
        raise TraceError(f"`{shorten(text)}` is too large for a number: at most 1.7e308")
    return number


_CLASSES = {Kind.BOOL: bool, Kind.INT: int, Kind.REAL: float, Kind.LABEL: str}

_LARGEST = 1 << 63

_EXACT = 1 << 53  # floats up to here are the whole numbers that they stand for


def fits(value: Any, kind: Kind) -> bool:
    """Whether a value is one of its kind, or unknown."""
    return value is None or value.__class__ is _CLASSES[kind]


def plain(cell: Any) -> Any:
    """A cell as Python has it: NumPy's scalars as numbers and texts, pandas' NA as `None`."""
    if cell.__class__ in (float, bool, int, str) or cell is None:
        return cell
    if type(cell).__name__ == "NAType":
        return None
    item = getattr(cell, "item", None)
    if callable(item) and getattr(cell, "ndim", 1) == 0:
        made = item()
        # Dates and durations would become numbers of some unit of theirs.
        return cell if getattr(cell.dtype, "kind", "") in "mM" or hasattr(made, "item") else made
    return cell


def as_declared(value: Any, kind: Kind) -> Any:
    """A value as its kind takes it; one that the kind does not take, as it is.

    Returns:
        0 and 1 as truth values, whole floats as the whole numbers that they are, whole numbers as
        reals; NaN where the kind has none as `None`, which is as unknown.

    >>> as_declared(1.0, Kind.BOOL), as_declared(3.0, Kind.INT), as_declared(3, Kind.REAL)
    (True, 3, 3.0)
    >>> as_declared(2, Kind.BOOL), as_declared(float("nan"), Kind.INT)
    (2, None)
    """
    if value.__class__ is _CLASSES[kind] or not isinstance(value, int | float):
        return value
    if value != value:
        return value if kind is Kind.REAL else None
    match kind:
        case Kind.BOOL if value in (0, 1):
            return value == 1
        case Kind.INT if isinstance(value, float) and value.is_integer() and abs(value) <= _EXACT:
            return int(value)
        case Kind.REAL if not isinstance(value, bool):
            with suppress(OverflowError):
                return float(value)
    return value


DESCRIPTION = {
    Kind.BOOL: "a truth value (true, false, 1 or 0)",
    Kind.INT: "a whole number",
    Kind.REAL: "a number",
    Kind.LABEL: "a label",
}


def first_line(error: Exception) -> str:
    """The first line of an error of another library."""
    return shorten(str(error).partition("\n")[0] or type(error).__name__, 120)
