"""Time as integer ticks of one nanosecond, with exact conversions from and to text and numbers."""

from __future__ import annotations

import math
import operator
import reprlib
from datetime import UTC, datetime
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from typing import Any

from rvmon.errors import TraceError

TICKS_PER_SECOND = 1_000_000_000

TIME_LIMIT = 1 << 62
"""Times and durations lie strictly between −TIME_LIMIT and TIME_LIMIT; sums saturate there."""

NEVER = 1 << 63  # later than any instant

TICKS_PER_UNIT = {
    "ns": 1,
    "us": 1_000,
    "ms": 1_000_000,
    "s": TICKS_PER_SECOND,
    "min": 60 * TICKS_PER_SECOND,
    "h": 3_600 * TICKS_PER_SECOND,
}
"""Units of duration, each as a whole number of ticks."""

UNIT_WORDS = {"s": "seconds", "ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds"}
"""The names of the units of stamps."""

_DATES_FROM = 946_684_800 * TICKS_PER_SECOND
"""The year 2000. Later stamps are counted from 1970, as no clock of a robot runs that long."""

_COARSE = 2.0**23  # from this many seconds on, the spacing of floats exceeds a tick
_FAR = 4e9  # a bound in seconds that is within `TIME_LIMIT`
_FEW_DIGITS = 28  # the most digits that are read as an integer, the fast path

_SURE = 0.4999
"""If a fraction times 1e9 is this near to an integer, it rounds as the exact product does."""


def ticks_of_seconds(seconds: float | Fraction | Decimal) -> int:
    """Seconds as ticks, rounded once to the nearest.

    Args:
        seconds: a finite number, also of NumPy; an `int`, `Fraction` or `Decimal` is converted
            exactly. A float whose spacing exceeds a tick, such as an instant since 1970, stands for
            the shortest decimal that reads as it (its `repr`), so that stamps written with a few
            digits are exact.

    Raises:
        TraceError: the value is no number, not finite or beyond `TIME_LIMIT` ticks.

    >>> ticks_of_seconds(0.1), ticks_of_seconds(1700000015.95)
    (100000000, 1700000015950000000)
    """
    if seconds.__class__ is float and _COARSE <= seconds < _FAR:
        return ticks_of_text(repr(seconds))
    if seconds.__class__ is float and -_COARSE < seconds < _COARSE:
        whole = int(seconds)
        part = (seconds - whole) * 1e9  # the difference is exact, the product nearly
        rest = round(part)
        if -_SURE < part - rest < _SURE:
            return whole * TICKS_PER_SECOND + rest
    if type(seconds) not in (float, int, Fraction):
        seconds = _plain(seconds)
    if isinstance(seconds, float) and not math.isfinite(seconds):
        raise TraceError(f"time {seconds} is not finite: give seconds as a finite number")
    ticks = round(Fraction(exact(seconds, "s")) * TICKS_PER_SECOND)
    if abs(ticks) >= TIME_LIMIT:
        shown = round(seconds) if isinstance(seconds, Fraction) else seconds
        raise TraceError(f"time {_shown(shown)} s is out of range: at most 2**62 ns (146 years)")
    return ticks


def exact(number: float | Fraction | Decimal, unit: str) -> float | Fraction | Decimal:
    """The exact value of a stamp; a float coarser than a tick stands for its shortest decimal."""
    coarse = isinstance(number, float) and math.ulp(number) * TICKS_PER_UNIT[unit] > 1
    return Decimal(repr(number)) if coarse else number


def whole_ticks(t: Any) -> int:
    """A number of ticks, also of NumPy, as a plain integer.

    Raises:
        TraceError: the value is not a whole number, or beyond `TIME_LIMIT`.

    >>> whole_ticks(5)
    5
    """
    try:
        ticks = operator.index(t)
    except TypeError:
        raise TraceError(
            f"time {reprlib.repr(t)} is not a whole number of nanoseconds: the methods without "
            "`_ns` take seconds"
        ) from None
    if not -TIME_LIMIT < ticks < TIME_LIMIT:
        raise TraceError(f"time {_shown(ticks)} ns is out of range: at most 2**62 ns (146 years)")
    return ticks


def _shown(number: float | Decimal) -> str:
    """A number as text for a message; a huge integer is not written out."""
    long = isinstance(number, int) and abs(number) > 10**30
    return "beyond 10**30" if long else repr(number)


def _plain(seconds: Any) -> float | Fraction:
    """A number of another type as a plain one."""
    try:
        # NumPy's dates and durations are refused: their `item` depends on their unit.
        kind = getattr(getattr(seconds, "dtype", None), "kind", "")
        if not isinstance(seconds, str) and kind not in ("m", "M"):
            plain = seconds.item() if hasattr(seconds, "item") else seconds
            return plain if isinstance(plain, float | int) else Fraction(plain)
    except (TypeError, ValueError, OverflowError):
        pass
    raise TraceError(
        f"time {reprlib.repr(seconds)} is not a finite number: give seconds as a number"
    )


def ticks_of_text(text: str, unit: str = "s") -> int:
    """Read a decimal number of a unit exactly as ticks, rounded once to the nearest.

    Args:
        text: the number.
        unit: one of `TICKS_PER_UNIT`.

    Raises:
        TraceError: the text is no finite decimal number, or out of range.

    >>> ticks_of_text("1700000000.123456789"), ticks_of_text("1e-3")
    (1700000000123456789, 1000000)
    """
    whole, _, part = text.partition(".")
    digits = whole + part
    if len(digits) <= _FEW_DIGITS and digits.isascii() and digits.isdecimal():
        parts: int = 10 ** len(part)
        ticks, rest = divmod(int(digits) * TICKS_PER_UNIT[unit], parts)
        if not rest and ticks < TIME_LIMIT:
            return ticks
    shown = reprlib.repr(text)[1:-1]
    try:
        # Python accepts 1_000 as a number; in a recording it is an error.
        number = Decimal(text.replace("_", "?"))
    except InvalidOperation:
        raise TraceError(f"time `{shown}` is not a number of {UNIT_WORDS[unit]}") from None
    if not number.is_finite():
        raise TraceError(f"time `{shown}` is not finite")
    # An exponent is bounded before it becomes digits: 1e999999999 must not fill the memory.
    if number.adjusted() <= 18:
        # A number this small is below a tick in any unit; its exact fraction would fill the memory.
        exact = Fraction(0) if number.adjusted() < -30 else Fraction(number)
        ticks = round(exact * TICKS_PER_UNIT[unit])
        if abs(ticks) < TIME_LIMIT:
            return ticks
    raise TraceError(f"time `{shown}` is out of range: at most 2**62 ns (146 years)")


def later(t: int, duration: int) -> int:
    """The instant `duration` ticks after `t`, saturating at `TIME_LIMIT`.

    >>> later(TIME_LIMIT - 1, 5) == TIME_LIMIT
    True
    """
    return min(t + duration, TIME_LIMIT)


def format_ticks(ticks: int) -> str:
    """Ticks as seconds, exactly; below a microsecond as nanoseconds.

    >>> format_ticks(14_250_000_000), format_ticks(3), format_ticks(0)
    ('14.25 s', '3 ns', '0 s')
    """
    if 0 < abs(ticks) < 1_000:
        return f"{ticks} ns"
    if ticks < 0:
        return f"-{format_ticks(-ticks)}"
    whole, rest = divmod(ticks, TICKS_PER_SECOND)
    return f"{whole}.{rest:09d}".rstrip("0") + " s" if rest else f"{whole} s"


def format_instant(t: int, origin: int) -> str:
    """An instant relative to the first one of its run (`origin`); both in ticks.

    >>> format_instant(1_700_000_014_250_000_000, 1_700_000_000_000_000_000)
    '14.25 s'
    """
    return format_ticks(t - origin)


def format_stamp(t: int) -> str:
    """An instant (ticks) as stamped in its recording, with the date if it is counted from 1970.

    >>> format_stamp(14_250_000_000), format_stamp(1_700_000_014_250_000_000)
    ('14.25 s', '1700000014.25 s, 2023-11-14 22:13:34 UTC')
    """
    if t < _DATES_FROM:
        return format_ticks(t)
    date = datetime.fromtimestamp(t // TICKS_PER_SECOND, UTC)
    return f"{format_ticks(t)}, {date:%Y-%m-%d %H:%M:%S} UTC"


def format_stamped(t: int, origin: int) -> str:
    """An instant relative to `origin`, with its stamp if the stamp differs; both in ticks.

    >>> format_stamped(14_250_000_000, 5_000_000_000), format_stamped(14_250_000_000, 0)
    ('9.25 s (stamp 14.25 s)', '14.25 s')
    """
    stamp = f" (stamp {format_stamp(t)})" if origin else ""
    return f"{format_instant(t, origin)}{stamp}"
