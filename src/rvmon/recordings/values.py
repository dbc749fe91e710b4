"""Conversion of texts and JSON values to values of a declared kind."""

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
"""The texts that programs write for a missing value. They are errors, with a hint: they could mean
unknown or no update."""


def scalar_of_text(text: str, kind: Kind) -> Scalar:
    """Read a cell that is not empty; `nan` (in any case) is NaN, except for labels.

    Raises:
        TraceError: the text is no value of the kind, or a number is too large.

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
            # Python reads 1_000 as a number; in a recording it is an error.
            try:
                if "_" not in text:
                    return _whole_of(text) if kind is Kind.INT else double_of(text)
            except TraceError:
                raise
            except ValueError:  # may be NaN, or 1.0 for an integer: see below
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
    raise TraceError(f"`{shorten(text)}` is too large for a whole number: at most 64 bits")


def double_of(text: str) -> float:
    """Read a number as a double; infinite only if the text says so in words.

    Raises:
        ValueError: the text is no number.
        TraceError: the number is too large for a double.

    >>> double_of("2.5"), double_of("-inf")
    (2.5, -inf)
    """
    number = float(text)
    if isinf(number) and any(map(str.isdigit, text)):
        raise TraceError(f"`{shorten(text)}` is too large for a number: at most 1.7e308")
    return number


_CLASSES = {Kind.BOOL: bool, Kind.INT: int, Kind.REAL: float, Kind.LABEL: str}

_LARGEST = 1 << 63

_EXACT = 1 << 53  # up to here, a float represents every integer exactly


def fits(value: Any, kind: Kind) -> bool:
    """Whether a value is of its kind, or `None` (unknown)."""
    return value is None or value.__class__ is _CLASSES[kind]


def plain(cell: Any) -> Any:
    """Convert a cell to a plain Python value: NumPy scalars to numbers or texts, NA to `None`."""
    if cell.__class__ in (float, bool, int, str) or cell is None:
        return cell
    if type(cell).__name__ == "NAType":
        return None
    item = getattr(cell, "item", None)
    if callable(item) and getattr(cell, "ndim", 1) == 0:
        made = item()
        # Dates and durations would become numbers in a unit that depends on their type.
        return cell if getattr(cell.dtype, "kind", "") in "mM" or hasattr(made, "item") else made
    return cell


def as_declared(value: Any, kind: Kind) -> Any:
    """Convert a value to its declared kind if it has a value of that kind; else leave it.

    Returns:
        For `bool`: 0 and 1 as truth values. For `int`: whole floats (up to 2**53) as integers. For
        `real`: integers as floats. NaN becomes `None` (unknown) for the kinds that have no NaN.

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
