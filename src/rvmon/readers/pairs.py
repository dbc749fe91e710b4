"""A trace that a program hands over item by item."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from rvmon.errors import TraceError
from rvmon.readers.gaps import Gaps
from rvmon.readers.rows import Row
from rvmon.readers.values import as_declared, plain
from rvmon.trace.schema import Kind, Schema
from rvmon.trace.time import ticks_of_seconds


def pair_rows(trace: Any, schema: Schema, gaps: Gaps) -> Iterator[Row]:
    """Number from 0, ticks and values of each item, which has to be `(t, values)`, t in seconds.

    Names that are absent are no update, `None` and NaN are unknown.

    Args:
        trace: an iterable.
        schema: the declared names; of others values are left as they are.
        gaps: values that stand for no update.

    Raises:
        TraceError: an item is something else.
    """
    for number, item in enumerate(trace):
        match item:
            case [t, Mapping() as values]:
                yield number, ticks_of_seconds(t), _values(values, schema, gaps)
            case _:
                raise TraceError(
                    f"item {number} of the trace: expected (t, values) with values by name, "
                    f"found {item!r}"
                )


def expect_pairs(trace: Any) -> None:
    """Refuse what cannot be gone through.

    Raises:
        TraceError: it is no iterable.
    """
    if not isinstance(trace, Iterable):
        raise TraceError(
            "expected a path, columns by name (arrays, a table, a data frame) or (t, values) "
            f"pairs, found {type(trace).__name__}"
        )


def _values(values: Mapping[str, Any], schema: Schema, gaps: Gaps) -> dict[str, Any]:
    found = {}
    for name, given in values.items():
        value = plain(given)
        if gaps and gaps.holds(value):
            continue
        if name in schema.events:
            found[name] = _occurrence(value, schema.events[name], gaps)
        elif name in schema.signals:
            found[name] = as_declared(value, schema.signals[name])
        else:
            found[name] = value
    return found


def _occurrence(value: Any, fields: Mapping[str, Kind], gaps: Gaps) -> Any:
    if isinstance(value, Mapping):
        plains = {field: plain(scalar) for field, scalar in value.items()}
        return {
            field: as_declared(scalar, fields[field]) if field in fields else scalar
            for field, scalar in plains.items()
            if not gaps.holds(scalar)
        }
    if isinstance(value, tuple | list):
        return tuple(_occurrence(one, fields, gaps) for one in value)
    return as_declared(value, Kind.BOOL)
