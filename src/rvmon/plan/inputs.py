"""What samples report of a name."""

from __future__ import annotations

from collections.abc import Mapping

from rvmon.trace.sample import Payload, Value

Reported = Value | tuple[Payload | None, ...]
"""What is taken for a name; a `None` among payloads is an unknown occurrence."""


def payloads_of(value: Reported) -> tuple[Payload | None, ...]:
    """The payloads of a report of an event: one per occurrence, `None` if it is unknown."""
    if isinstance(value, tuple):
        return value
    if isinstance(value, Mapping):
        return (value,)
    return (None,) if value is None else ({},) if value is True else ()
