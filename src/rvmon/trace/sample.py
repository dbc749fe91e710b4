"""What arrives: samples of signals and events; and why something was not known (input health).

Source: SEMANTICS 1 and 6.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol


class HealthKind(StrEnum):
    """A cause of not knowing."""

    MISSING = "missing"
    ABSENT = "absent"
    NAN = "nan"
    NONE = "none"
    STALE = "stale"
    LATE = "late"
    CONFLICT = "conflict"
    IGNORED = "ignored"
    DROPPED = "dropped"
    UNIT = "unit"
    CLOCK = "clock"
    INTERRUPTED = "interrupted"
    CUT = "cut off"


_DOUBTS = (HealthKind.UNIT, HealthKind.CLOCK, HealthKind.CUT)


@dataclass(frozen=True, slots=True)
class Health:
    """One kind of trouble with one input on one run.

    Attributes:
        kind: what it was.
        name: the signal or event, or the column.
        count: how often.
        first: the first instant, ticks; `None` if it has none.
        requirements: ids of the requirements that read the name.
        remark: more for people, or empty.
    """

    kind: HealthKind
    name: str
    count: int = 1
    first: int | None = None
    requirements: tuple[str, ...] = ()
    remark: str = ""

    @property
    def is_doubt(self) -> bool:
        """Whether it is a warning: the recording may not be what it seems."""
        return self.kind in _DOUBTS


Scalar = bool | int | float | str | None
"""A signal's value; `None` makes the signal unknown."""

Payload = Mapping[str, Scalar]
"""The fields of one occurrence of an event."""

Value = Scalar | Payload | tuple[Payload, ...]
"""What a sample says of a name: a signal's value; of an event `True`, its payload or payloads."""


def payloads_of(value: Value) -> tuple[Payload | None, ...]:
    """The payloads of a report of an event: one per occurrence, `None` if it is unknown."""
    if isinstance(value, tuple):
        return value
    if isinstance(value, Mapping):
        return (value,)
    return (None,) if value is None else ({},) if value is True else ()


def calculated(operation: Callable[..., float], *values: Scalar) -> float | None:
    """What an operation on numbers gives; unknown if one is, or if it is no finite number.

    So is what bits a number has that is not whole.
    """
    for value in values:
        if value is None or isinstance(value, str):
            return None
    try:
        result = operation(*values)
        return result if math.isfinite(result) else None
    except (TypeError, ValueError, OverflowError, ZeroDivisionError):
        return None


@dataclass(frozen=True, slots=True)
class Sample:
    """All that became known at one instant.

    Attributes:
        t: ticks.
        values: by name, only what was updated or occurred.
    """

    t: int
    values: Mapping[str, Value]

    def without(self, names: Set[str]) -> Sample:
        """The same with nothing of some names."""
        return Sample(self.t, {name: self.values[name] for name in self.values.keys() - names})


@dataclass(frozen=True, slots=True)
class Outage:
    """A stretch of a recording in which names were lost.

    Attributes:
        since: its first instant, ticks.
        until: its last one.
        why: it is one.
        names: that were lost; `None`: all.
    """

    since: int
    until: int
    why: str
    names: frozenset[str] | None = None


class Recording(Protocol):
    """A finished trace that can be read once from its start."""

    @property
    def names(self) -> frozenset[str] | None:
        """The signals and events that have a source (a column, a topic); `None`: any may come."""

    @property
    def end(self) -> int | None:
        """The instant at which the recording ended, in ticks, if it says so by itself."""

    def __iter__(self) -> Iterator[Sample]: ...


@dataclass(frozen=True, slots=True)
class Trace:
    """Samples in memory.

    Attributes:
        samples: with strictly increasing `t`.
        names: the names that have a source; `None` if any may come.
        end: the instant at which the recording ended, in ticks; `None`: at its last sample.
        outages: what it lost.
    """

    samples: tuple[Sample, ...]
    names: frozenset[str] | None = None
    end: int | None = None
    outages: Sequence[Outage] = ()

    def __iter__(self) -> Iterator[Sample]:
        return iter(self.samples)
