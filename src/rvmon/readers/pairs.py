"""A trace that a program hands over item by item."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from rvmon.errors import TraceError
from rvmon.readers.rows import Row, Rows
from rvmon.readers.values import as_declared, plain
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Gaps, Kind, Schema
from rvmon.trace.time import ticks_of_seconds


class PairRecording:
    """Pairs `(t, values)`, t in seconds, as a recording.

    Names that are absent are no update, `None` and NaN are unknown.

    Attributes:
        names: `None`: any may come.
        end: `None`: it ends with its last item.
        rows: what makes samples of it.
    """

    names: frozenset[str] | None = None
    end: int | None = None

    def __init__(self, trace: Any, schema: Schema, *, ordered: bool = True) -> None:
        """Take what can be gone through.

        Args:
            trace: an iterable.
            schema: the declared names; of others values are left as they are.
            ordered: whether a stamp before the one above it is an error. Under `max delay` rows are
                put in order instead.

        Raises:
            TraceError: it is no iterable.
        """
        if not isinstance(trace, Iterable):
            raise TraceError(
                "expected a path, columns by name (arrays, a table, a data frame) or (t, values) "
                f"pairs, found {type(trace).__name__}"
            )
        self.rows = Rows(schema, "item", ordered=ordered)
        self._trace = trace
        self._schema = schema

    def __iter__(self) -> Iterator[Sample]:
        """Samples, equal stamps merged.

        Raises:
            TraceError: an item is something else.
        """
        return self.rows.samples(self._read())

    def _read(self) -> Iterator[Row]:
        """Number from 0, ticks and values of each item."""
        for number, item in enumerate(self._trace):
            match item:
                case [t, Mapping() as values]:
                    yield number, ticks_of_seconds(t), _values(values, self._schema)
                case _:
                    raise TraceError(
                        f"item {number} of the trace: expected (t, values) with values by name, "
                        f"found {item!r}"
                    )


def _values(values: Mapping[str, Any], schema: Schema) -> dict[str, Any]:
    found, gaps = {}, schema.gaps
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
