"""A trace as a word: one letter per position, with everything that propositions can read there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum, IntEnum, auto

from rvmon.language.checked.formula import Probe
from rvmon.trace.sample import Payload, Scalar


@dataclass(frozen=True, slots=True)
class Outage:
    """An outage, in which any number of updates of some names may have been lost.

    The trace extends to the last instant of an outage, as time passed all the same. If a source is
    lost for good, the last instant is the latest that time is known to have reached.

    Attributes:
        names: the signals and events that may have been updated. It may be empty, as in sampled
            time a sample without updates is a position, too.
        first: its first instant, ticks.
        last: its last instant, ticks; not before the first.

    Source: SEMANTICS, section 1 (Outage).
    """

    names: frozenset[str]
    first: int
    last: int

    def __post_init__(self) -> None:
        if self.last < self.first:
            raise ValueError(f"an outage from {self.first} ns to {self.last} ns: no time at all")

    def covers(self, instant: int) -> bool:
        """Whether an instant lies within it."""
        return self.first <= instant <= self.last

    def touches(self, before: int | None, instant: int) -> bool:
        """Whether a tick of it lies after `before`, up to `instant`."""
        return self.first <= instant and (before is None or before < self.last)

    def hides(self, instant: int) -> bool:
        """Whether a lost update may have come after the one that was read at an instant.

        An update at the last instant ended the outage, so nothing was lost after it. In an outage
        of a single instant, updates may have been lost before or after the one that was read.
        """
        return self.covers(instant) and not self.first < instant == self.last


class Truth(IntEnum):
    """The truth of a formula at a position."""

    FALSE = 0
    UNKNOWN = 1
    TRUE = 2
    UNBORN = 3
    """A formula of the present and past reads a signal that has had no value so far."""


_NEGATION = (Truth.TRUE, Truth.UNKNOWN, Truth.FALSE, Truth.UNBORN)
_FALSE_FIRST = (0, 1, 3, 2)
_TRUE_FIRST = (3, 1, 0, 2)
"""The rank of each truth in a conjunction, above in a disjunction: the least rank wins."""


def negation(value: Truth) -> Truth:
    """Exchange TRUE and FALSE.

    >>> negation(Truth.UNKNOWN).name
    'UNKNOWN'
    """
    return _NEGATION[value]


def conjunction(values: Iterable[Truth]) -> Truth:
    """FALSE if any is, else UNKNOWN if any is, else UNBORN if any is; TRUE of no values.

    >>> conjunction([Truth.UNBORN, Truth.TRUE]).name
    'UNBORN'
    >>> conjunction([Truth.UNBORN, Truth.UNKNOWN]).name
    'UNKNOWN'
    """
    return min(values, key=_FALSE_FIRST.__getitem__, default=Truth.TRUE)


def disjunction(values: Iterable[Truth]) -> Truth:
    """TRUE if any is, else UNKNOWN if any is, else UNBORN if any is; FALSE of no values."""
    return min(values, key=_TRUE_FIRST.__getitem__, default=Truth.FALSE)


def both(truth: Truth, other: Truth) -> Truth:
    """The conjunction of two values; faster than `conjunction`."""
    return truth if _FALSE_FIRST[truth] <= _FALSE_FIRST[other] else other


def either(truth: Truth, other: Truth) -> Truth:
    """The disjunction of two values; faster than `disjunction`."""
    return truth if _TRUE_FIRST[truth] <= _TRUE_FIRST[other] else other


def truth_of(value: bool) -> Truth:
    """TRUE or FALSE."""
    return Truth.TRUE if value else Truth.FALSE


def born_or_true(value: Truth) -> Truth:
    """Read UNBORN as TRUE."""
    return Truth.TRUE if value is Truth.UNBORN else value


def born_or_false(value: Truth) -> Truth:
    """Read UNBORN as FALSE."""
    return Truth.FALSE if value is Truth.UNBORN else value


@dataclass(frozen=True, slots=True)
class Update:
    """The value of a signal in a sample; `None` if unknown or NaN."""

    t: int
    value: Scalar


@dataclass(frozen=True, slots=True)
class SignalState:
    """The state of a signal at a position, as far as it is known.

    Attributes:
        value: the held value; `None` if unknown for any reason.
        updated: whether an update belongs to this position; UNKNOWN for a name without a source.
        changed: whether an update to another value belongs to this position.
        last: the last update so far.
        before: the update before `last`.
        born: whether an update has brought a known value so far, or may have in an outage.
        moved: whether a further update has come since, or may have in an outage.
        lost: whether the value is unknown because of an outage.
    """

    value: Scalar = None
    updated: Truth = Truth.FALSE
    changed: Truth = Truth.FALSE
    last: Update | None = None
    before: Update | None = None
    born: bool = False
    moved: bool = False
    lost: bool = False


@dataclass(frozen=True, slots=True)
class Occurrence:
    """An occurrence of an event at a position, and its payload; UNKNOWN if it is uncertain."""

    truth: Truth
    payload: Payload


@dataclass(frozen=True, slots=True)
class EventState:
    """The state of an event at a position, as far as it is known.

    Attributes:
        updated: whether the event was reported, as occurring or as not occurring.
        occurrences: the certain and the possible occurrences.
        lost: how many of them stand for occurrences that may have been lost.
    """

    updated: Truth = Truth.FALSE
    occurrences: tuple[Occurrence, ...] = ()
    lost: int = 0


@dataclass(frozen=True, slots=True)
class Letter:
    """A position: its instant and the state of every declared name.

    Attributes:
        instant: its instant, ticks.
        signals: the state of each signal.
        events: the state of each event.
        sure: whether the position certainly exists. In an outage of sampled time, and before the
            first sample that was read, it may not.
        since: the instant of the first position, ticks; `None` if unknown.
    """

    instant: int
    signals: Mapping[str, SignalState]
    events: Mapping[str, EventState]
    sure: bool = True
    since: int | None = None


@dataclass(frozen=True, slots=True)
class Word:
    """All positions of a trace.

    Attributes:
        letters: one per position; instants increase strictly.
        end: the last instant whose letter is known, ticks; `None` before the first sample.
        reached: the instant that time is known to have reached, ticks.
    """

    letters: tuple[Letter, ...]
    end: int | None
    reached: int


class Rest(Enum):
    """Assumptions about pending operators, beyond the known positions."""

    UNKNOWN = auto()
    """No assumption: the truth after a prefix."""

    END = auto()
    """The trace has ended: an unbounded `always` whose window has opened counts as TRUE."""

    WEAK = auto()
    """All pending operators count as TRUE."""

    STRONG = auto()
    """All pending operators count as FALSE."""


def probed(probe: Probe, name: str, letter: Letter) -> Truth:
    """Whether a name was updated, changed, or is known at a position."""
    if name in letter.events:
        event = letter.events[name]
        if probe is Probe.UPDATED:
            return event.updated
        raise ValueError(f"`{probe}({name})`: only `updated` reads events")
    signal = letter.signals[name]
    match probe:
        case Probe.UPDATED:
            return signal.updated
        case Probe.KNOWN:
            return Truth.UNKNOWN if signal.lost else truth_of(signal.value is not None)
        case Probe.CHANGED:
            return signal.changed
