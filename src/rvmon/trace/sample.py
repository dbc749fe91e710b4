"""Samples of signals and events, outages, and input health.

Source: SEMANTICS 1 and 6.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol


class HealthKind(StrEnum):
    """A kind of finding about the input: a cause of unknown values, or a warning."""

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
    """One kind of finding about one input on one run.

    Attributes:
        kind: the kind.
        name: the signal, event or column.
        count: the number of occurrences.
        first: the first instant, ticks; `None` if it has none.
        requirements: ids of the requirements that read the name.
        remark: further explanation, or "".
    """

    kind: HealthKind
    name: str
    count: int = 1
    first: int | None = None
    requirements: tuple[str, ...] = ()
    remark: str = ""

    @property
    def is_doubt(self) -> bool:
        """Whether the finding warns that the recording may be misread."""
        return self.kind in _DOUBTS


Scalar = bool | int | float | str | None  # a signal's value; `None` makes the signal unknown
Payload = Mapping[str, Scalar]  # the fields of one occurrence of an event

Value = Scalar | Payload | tuple[Payload, ...]
"""The entry of a name in a sample: the value of a signal; for an event a truth value or payloads.

`None` is unknown: the signal has no known value, or the event may have occurred.
"""


def payloads_of(value: Value) -> tuple[Payload | None, ...]:
    """The payloads in the value of an event: one per occurrence; `None` for an unknown one."""
    if isinstance(value, tuple):
        return value
    if isinstance(value, Mapping):
        return (value,)
    return (None,) if value is None else ({},) if value is True else ()


def calculated(operation: Callable[..., float], *values: Scalar) -> float | None:
    """The result of a numeric operation; `None` if it has no finite value or an operand is unknown.

    A bit operation on numbers that are not integers has no value either.
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
    """The updates and occurrences at one instant.

    Attributes:
        t: the instant, ticks.
        values: by name; only names that were updated or occurred.
    """

    t: int
    values: Mapping[str, Value]

    def without(self, names: Set[str]) -> Sample:
        """The sample without some names."""
        return Sample(self.t, {name: self.values[name] for name in self.values.keys() - names})


@dataclass(frozen=True, slots=True)
class Outage:
    """A stretch of a recording in which updates of names may have been lost.

    Attributes:
        since: its first instant, ticks.
        until: its last instant, ticks.
        why: its cause, in words.
        names: the names concerned; `None`: all.
    """

    since: int
    until: int
    why: str
    names: frozenset[str] | None = None


class Recording(Protocol):
    """A finished trace that can be read once from its start."""

    @property
    def names(self) -> frozenset[str] | None:
        """The signals and events that have a source (a column, a topic); `None`: any may occur."""

    @property
    def end(self) -> int | None:
        """The instant at which the recording ended, ticks; `None` if the recording has none."""

    def __iter__(self) -> Iterator[Sample]: ...


@dataclass(frozen=True, slots=True)
class Trace:
    """Samples in memory.

    Attributes:
        samples: with strictly increasing `t`.
        names: the names that have a source; `None` if any may occur.
        end: the instant at which the recording ended, ticks; `None`: at its last sample.
        outages: its outages.
    """

    samples: tuple[Sample, ...]
    names: frozenset[str] | None = None
    end: int | None = None
    outages: Sequence[Outage] = ()

    def __iter__(self) -> Iterator[Sample]:
        return iter(self.samples)
