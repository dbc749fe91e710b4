"""What is known of signals and events at a position."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from rvmon.runtime.past import History
from rvmon.trace.sample import Payload, Scalar, Value

Reported = Value | tuple[Payload | None, ...]
"""What is taken for a name; a `None` among payloads is an unknown occurrence."""


class Input(Protocol):
    """What expressions read."""

    def value_of(self, signal: str) -> Scalar:
        """The value of a signal; `None` if it is unknown."""

    def history_of(self, signal: str) -> History:
        """Its last two updates."""

    def payloads_of(self, event: str) -> Sequence[Payload | None]:
        """What occurs of an event; `None` is unknown."""


class OneSample:
    """The input of a run that begins with one sample: an `Input`."""

    def __init__(self, values: Mapping[str, Reported]) -> None:
        self._values = values

    def value_of(self, signal: str) -> Scalar:
        """See `Input`."""
        value = self._values.get(signal)
        if isinstance(value, Mapping | tuple) or value != value:
            return None
        return value

    def history_of(self, signal: str) -> History:  # noqa: ARG002 (none has one yet)
        """See `Input`."""
        return History()

    def payloads_of(self, event: str) -> Sequence[Payload | None]:
        """See `Input`."""
        return payloads_of(self._values.get(event, False))


def payloads_of(value: Reported) -> tuple[Payload | None, ...]:
    """The payloads of a report of an event: one per occurrence, `None` if it is unknown."""
    if isinstance(value, tuple):
        return value
    if isinstance(value, Mapping):
        return (value,)
    return (None,) if value is None else ({},) if value is True else ()
