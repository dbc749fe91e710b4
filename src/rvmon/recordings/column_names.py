"""By what names a recording calls its time and what the spec declares."""

from __future__ import annotations

import re
from collections.abc import Collection

from rvmon.errors import TraceError
from rvmon.recordings.values import shorten
from rvmon.texts import did_you_mean
from rvmon.trace.schema import Schema, Stamps
from rvmon.trace.stamps import UNITS, stamps_of

DEFAULT_COLUMNS = ("t", "t_ns")
"""The columns of stamps where none was named."""


def stamps_among(names: Collection[str], schema: Schema) -> Stamps:
    """The column of stamps of a recording that has these columns.

    Raises:
        TraceError: there is none, or there are two.
    """
    stamps = schema.stamps
    listed = ", ".join(f"`{shorten(name)}`" for name in list(names)[:8]) or "nothing"
    if stamps is not None:
        if stamps.column in names:
            return stamps
        is_unit_meant = ":" in stamps.column and not stamps.is_stated
        units = f" (the units are {', '.join(UNITS)})" if is_unit_meant else ""
        meant = did_you_mean(stamps.column, names, f"there are {listed}")
        raise TraceError(f"no time column `{shorten(stamps.column)}`: {meant}{units}")
    times = [name for name in DEFAULT_COLUMNS if name in names]
    if len(times) != 1:
        close = [name for name in names if re.search(r"time|stamp|^sec", name, re.IGNORECASE)]
        which = f": `{shorten(close[0])}` looks like it" if close and not times else ""
        raise TraceError(
            "expected one time column, `t` (seconds) or `t_ns` (integer nanoseconds), found "
            f"{'both' if times else listed}{which}: name {'one of them' if times else 'it'} with "
            "--time COLUMN[:UNIT], in Python time=…"
        )
    return stamps_of(times[0])


def aliases_of(schema: Schema) -> dict[str, str]:
    """The declared name by column, where it has another one; what no longer counts has none.

    >>> aliases_of(Schema({}, {}, columns={"speed": "Speed [m/s]"}))
    {'speed': '', 'Speed [m/s]': 'speed'}
    """
    own = {column: name for name, column in schema.columns.items()}
    return {**dict.fromkeys(schema.columns, ""), **own}
