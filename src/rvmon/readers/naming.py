"""By what names a recording calls its time and what the spec declares."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

from rvmon.diagnostics.nearest import did_you_mean
from rvmon.errors import RvmonError, TraceError, UnknownNameError
from rvmon.readers.values import shorten
from rvmon.trace.binding import Binding, Clock
from rvmon.trace.gaps import gaps_of
from rvmon.trace.schema import Schema, Stamps
from rvmon.trace.stamps import UNITS, stamps_of

DEFAULT_COLUMNS = ("t", "t_ns")
"""The columns of stamps where none was named."""


def read_as(
    schema: Schema,
    *,
    time: str | None = None,
    columns: Mapping[str, str] | None = None,
    nan: str | None = None,
    no_update: Any = None,
    binding: Binding | None = None,
    clock: str | None = None,
) -> Schema:
    """A schema for recordings that name things otherwise; see `rvmon.session.Spec.reading`.

    Raises:
        UnknownNameError: `columns` names what is not declared, or there is no such reading of NaN,
            or no such clock.
        RvmonError: `columns` names a column twice.
    """
    fields = [f"{name}.{field}" for name, own in schema.events.items() for field in own]
    declared = [*schema.signals, *schema.events, *fields]
    given = dict(columns or {})
    for name, column in given.items():
        if name not in declared:
            meant = did_you_mean(name, declared, f"there are {', '.join(declared)}")
            raise UnknownNameError(f"nothing named `{name}` to map `{column}` to: {meant}")
        if list(given.values()).count(column) > 1:
            raise RvmonError(f"column `{column}` is mapped to two names: one column, one name")
    if clock is not None and clock not in list(Clock):
        raise UnknownNameError(f"no clock `{clock}`: there is {' and '.join(Clock)}")
    gaps, bound = schema.gaps, schema.binding if binding is None else binding
    return replace(
        schema,
        stamps=schema.stamps if time is None else stamps_of(time),
        columns={**schema.columns, **given},
        gaps=gaps_of(
            gaps.reading_of_nan if nan is None else nan,
            gaps.no_update if no_update is None else no_update,
        ),
        binding=bound if clock is None else replace(bound, clock=Clock(clock)),
    )


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
        units = "" if stamps.is_stated else _units_listed(stamps.column)
        meant = did_you_mean(stamps.column, names, f"there are {listed}")
        raise TraceError(f"no time column `{shorten(stamps.column)}`: {meant}{units}")
    times = [name for name in DEFAULT_COLUMNS if name in names]
    if len(times) != 1:
        raise TraceError(
            "expected one time column, `t` (seconds) or `t_ns` (integer nanoseconds), "
            f"in the header; found {'both' if times else listed}: name "
            f"{'one of them' if times else 'it'} with --time COLUMN[:UNIT], in Python "
            f"time=…"
        )
    return stamps_of(times[0])


def _units_listed(column: str) -> str:
    return f" (the units are {', '.join(UNITS)})" if ":" in column else ""


def aliases_of(schema: Schema) -> dict[str, str]:
    """The declared name by column, where it has another one; what no longer counts has none.

    >>> aliases_of(Schema({}, {}, columns={"speed": "Speed [m/s]"}))
    {'speed': '', 'Speed [m/s]': 'speed'}
    """
    own = {column: name for name, column in schema.columns.items()}
    return {**dict.fromkeys(schema.columns, ""), **own}
