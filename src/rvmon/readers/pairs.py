"""A trace that a program hands over item by item."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from rvmon.errors import TraceError


def pairs_of(trace: Any) -> Iterator[tuple[Any, Mapping[str, Any]]]:
    """The items of a trace, which have to be `(t, values)`.

    Raises:
        TraceError: one is something else, or the trace is no sequence.
    """
    if not isinstance(trace, Iterable):
        raise TraceError(
            f"expected a path, columns by name or (t, values) pairs, found {type(trace).__name__}"
        )
    for number, item in enumerate(trace):
        match item:
            case [t, Mapping() as values]:
                yield t, values
            case _:
                raise TraceError(
                    f"item {number} of the trace: expected (t, values) with values by name, "
                    f"found {item!r}"
                )
