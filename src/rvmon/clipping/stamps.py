"""Instants as recordings write them."""

from __future__ import annotations

import math
from datetime import UTC, datetime, timedelta
from fractions import Fraction

from rvmon.trace.schema import Stamps
from rvmon.trace.stamps import ticks_of_stamp
from rvmon.trace.time import TICKS_PER_SECOND, TICKS_PER_UNIT

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


def stamp_text(ticks: int, stamps: Stamps) -> str:
    """An instant as a cell of text, exactly.

    >>> stamp_text(1_500_000, Stamps("t", "ms")), stamp_text(-1, Stamps("t", "iso"))
    ('1.5', '1969-12-31T23:59:59.999999999Z')
    """
    if stamps.unit == "iso":
        seconds, rest = divmod(ticks, TICKS_PER_SECOND)
        whole = _EPOCH + timedelta(seconds=seconds)
        return f"{whole:%Y-%m-%dT%H:%M:%S}.{rest:09d}Z"
    per_unit = TICKS_PER_UNIT[stamps.unit]
    whole_units, rest = divmod(abs(ticks), per_unit)
    digits = f"{rest:0{len(str(per_unit)) - 1}d}".rstrip("0") if rest else ""
    return f"{'-' if ticks < 0 else ''}{whole_units}{'.' + digits if digits else ''}"


def stamp_number(ticks: int, stamps: Stamps) -> int | float:
    """An instant as a number that is read as this instant, or as the nearest one before it.

    >>> stamp_number(2 * 10**9, Stamps("t", "s")), stamp_number(10**8, Stamps("t", "s"))
    (2, 0.1)
    """
    whole, rest = divmod(ticks, TICKS_PER_UNIT[stamps.unit])
    if not rest:
        return whole
    number = float(Fraction(ticks, TICKS_PER_UNIT[stamps.unit]))
    while ticks_of_stamp(number, stamps) > ticks:
        number = math.nextafter(number, -math.inf)
    return number
