"""The stamps of recordings: their column, and exact conversion to ticks."""

from __future__ import annotations

import math
import re
import reprlib
from collections.abc import Collection
from contextlib import suppress
from datetime import UTC, datetime
from decimal import Decimal
from fractions import Fraction
from typing import Any

from rvmon.errors import TraceError
from rvmon.texts import did_you_mean, shorten
from rvmon.trace.schema import Schema, Stamps
from rvmon.trace.time import (
    TICKS_PER_SECOND,
    TICKS_PER_UNIT,
    TIME_LIMIT,
    UNIT_WORDS,
    exact,
    ticks_of_seconds,
    ticks_of_text,
    whole_ticks,
)

UNITS = (*UNIT_WORDS, "iso")  # the units of stamps

_ISO = re.compile(
    r"(?P<date>\d{4}-?\d\d-?\d\d)"
    r"(?:[T ](?P<clock>\d\d:?\d\d(?::?\d\d(?:[.,](?P<part>\d{1,9})0*)?)?)"
    r" ?(?P<zone>Z|[+-]\d\d(?::?\d\d)?)?)?",
    re.ASCII | re.IGNORECASE,
)

_SHOWN = reprlib.Repr()
_SHOWN.maxstring = 60

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)

_EPOCHS = {"ms": (1e11, 1e14), "us": (1e14, 1e17), "ns": (1e17, 1e20)}
"""By unit, the range of numbers that are probably instants since 1970 in that unit, not in s."""


def stamps_of(text: str) -> Stamps:
    """Parse `COLUMN` or `COLUMN:UNIT`; without a unit, a column `…_ns` is in nanoseconds.

    `SECONDS+NANOSECONDS` names two columns to be added. A pattern of dates (`:%…`) can stand in
    place of the unit.

    >>> stamps_of("stamp:ms")
    Stamps(column='stamp', unit='ms', is_stated=True, pattern='')
    >>> stamps_of("t_ns")
    Stamps(column='t_ns', unit='ns', is_stated=False, pattern='')
    """
    column, pattern, rest = text.partition(":%")
    if pattern:
        return Stamps(column, "iso", is_stated=True, pattern=f"%{rest}")
    column, colon, unit = text.rpartition(":")
    if colon and unit in UNITS:
        return Stamps(column, unit, is_stated=True)
    return Stamps(text, "ns" if text.endswith("_ns") or "+" in text else "s")


def ticks_of_cell(text: str, stamps: Stamps) -> int:
    """Read a stamp of a text file exactly.

    Raises:
        TraceError: the text is no stamp in that unit, or is out of range.

    >>> ticks_of_cell("1.5", stamps_of("t:ms"))
    1500000
    """
    if not text.strip():
        raise TraceError("there is no time")
    if stamps.unit == "iso":
        return ticks_of_iso(text)
    if stamps.unit != "ns":
        try:
            return ticks_of_text(text, stamps.unit)
        except TraceError as error:
            raise TraceError(f"{error}{_other_unit(text, stamps)}") from None
    with suppress(ValueError):
        # Python accepts 1_000 as a number; in a recording it is an error.
        t = int(text.replace("_", "?"))
        if abs(t) < TIME_LIMIT:
            return t
    shown = _SHOWN.repr(text)[1:-1]
    # `int` refuses more than some thousand digits; such a text is out of range, not malformed.
    if is_whole(text):
        raise TraceError(f"time `{shown}` is out of range: at most 2**62 ns (146 years)")
    raise TraceError(f"time `{shown}` is not a whole number of nanoseconds")


def is_whole(text: str) -> bool:
    """Whether the text is a whole number, of any length."""
    return re.fullmatch(r"\s*[+-]?\d+\s*", text) is not None


def ticks_of_stamp(stamp: Any, stamps: Stamps) -> int:
    """A stamp as ticks.

    Args:
        stamp: for `s`, `ms` and `us` any number, for `ns` an integer, for `iso` a text or date.
        stamps: gives the unit.

    Raises:
        TraceError: the value is no stamp in that unit, or is out of range.

    >>> ticks_of_stamp(1_500, stamps_of("t:us")), ticks_of_stamp(0.25, stamps_of("t:ms"))
    (1500000, 250000)
    """
    if stamps.unit == "iso":
        return ticks_of_iso(str(stamp))
    plain = stamp.item() if hasattr(stamp, "item") else stamp
    if not isinstance(plain, bool):
        try:
            if isinstance(plain, int):
                return _whole(plain, stamps.unit)
            if isinstance(plain, float | Fraction | Decimal) and stamps.unit != "ns":
                return _rounded(plain, stamps.unit)
        except TraceError as error:
            raise TraceError(f"{error}{_other_unit(plain, stamps)}") from None
    wanted = "a whole number" if stamps.unit == "ns" else "a number"
    shown = _SHOWN.repr(str(plain))
    if not isinstance(plain, str):  # a text keeps its quotes, as it may look like a number
        shown = shown[1:-1]
    raise TraceError(
        f"time `{shown}` is not {wanted} of {UNIT_WORDS[stamps.unit]}{_other_unit(plain, stamps)}"
    )


def _whole(stamp: int, unit: str) -> int:
    ticks = stamp * TICKS_PER_UNIT[unit]
    if abs(ticks) < TIME_LIMIT:
        return ticks
    return whole_ticks(stamp) if unit == "ns" else ticks_of_seconds(_seconds(stamp, unit))


def _rounded(stamp: float | Fraction | Decimal, unit: str) -> int:
    if unit == "s" or not math.isfinite(stamp):
        return ticks_of_seconds(stamp)
    return ticks_of_seconds(_seconds(stamp, unit))


def _seconds(stamp: float | Fraction | Decimal, unit: str) -> Fraction:
    return Fraction(exact(stamp, unit)) * TICKS_PER_UNIT[unit] / TICKS_PER_SECOND


def ticks_of_iso(text: str) -> int:
    """Read an ISO 8601 date and time exactly as ticks since 1970; the default offset is UTC.

    >>> ticks_of_iso("1970-01-01T02:00:00.000000001+02:00")
    1
    """
    shown = _SHOWN.repr(text)[1:-1]
    match = _ISO.fullmatch(text.strip())
    if match is None:
        raise TraceError(
            f"time `{shown}` is not a date and time of ISO 8601 such as "
            "2024-05-01T12:00:00.123456789+02:00, with at most nine digits after the point"
        )
    clock = (match["clock"] or "00:00").replace(",", ".").partition(".")[0]
    try:
        whole = datetime.fromisoformat(f"{match['date']}T{clock}{(match['zone'] or 'Z').upper()}")
        since = whole - _EPOCH
    except (ValueError, OverflowError) as error:
        raise TraceError(f"time `{shown}` does not exist: {error}") from None
    seconds = since.days * 86_400 + since.seconds
    return whole_ticks(seconds * TICKS_PER_SECOND + int((match["part"] or "0").ljust(9, "0")))


def _other_unit(stamp: object, stamps: Stamps) -> str:
    """A hint at the unit that was probably meant, if the user did not name one."""
    if stamps.is_stated:
        return ""
    # `20240501` could be a date, but is read as a number.
    if _ISO.fullmatch(str(stamp).strip()) and not str(stamp).isdigit():
        return f": is this ISO 8601? `--time {stamps.column}:iso`"
    with suppress(ValueError):
        number = abs(float(str(stamp)))
        if stamps.unit == "ns" and math.isfinite(number) and not number.is_integer():
            return f". Are these seconds? `--time {stamps.column}:s`"
        for unit, (least, most) in _EPOCHS.items():
            if stamps.unit == "s" and least <= number < most:
                return f". Are these {UNIT_WORDS[unit]}? `--time {stamps.column}:{unit}`"
    return ""


DEFAULT_COLUMNS = ("t", "t_ns")  # the columns of stamps if the user names none


def stamps_among(names: Collection[str], schema: Schema) -> Stamps:
    """Find the column of stamps among the columns of a recording.

    Raises:
        TraceError: there is none, or there are two.
    """
    stamps = schema.stamps
    shown = [f"`{shorten(name)}`" if name else "one without a name" for name in list(names)[:8]]
    listed = ", ".join(shown) or "nothing"
    if stamps is not None:
        if stamps.column in names:
            return stamps
        is_unit_meant = ":" in stamps.column and not stamps.is_stated
        units = f" (the units are {', '.join(UNITS)})" if is_unit_meant else ""
        meant = did_you_mean(stamps.column, names, f"there are {listed}")
        raise TraceError(f"no time column `{shorten(stamps.column)}`: {meant}{units}")
    times = [name for name in DEFAULT_COLUMNS if name in names]
    if len(times) != 1:
        close = [name for name in names if re.search(r"time|stamp|^sec|^t$", name, re.IGNORECASE)]
        which = f": `{shorten(close[0])}` looks like it" if close and not times else ""
        nameless = " (:UNIT for the one without a name)" if "" in names else ""
        raise TraceError(
            "expected one time column, `t` (seconds) or `t_ns` (integer nanoseconds), found "
            f"{'both' if times else listed}{which}: name {'one of them' if times else 'it'} with "
            f"--time COLUMN[:UNIT]{nameless}, in Python time=…"
        )
    return stamps_of(times[0])
