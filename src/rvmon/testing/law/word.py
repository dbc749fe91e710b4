"""A trace as a word: one letter per position, with all that the propositions can read there.

An outage is a stretch of time over which a source may have said anything.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum, IntEnum, auto

from rvmon.language.checked.formula import Probe
from rvmon.trace.sample import Payload, Scalar


@dataclass(frozen=True, slots=True)
class Outage:
    """An outage: any number of updates of some names may have been lost.

    The trace reaches to its last instant: the passing of time is not among the losses. If a source
    is lost for good, its last instant is the latest that time is known to have reached.

    Attributes:
        names: the signals and events that may have been updated; may be empty, as a line without
            updates is a position of sampled time all the same.
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
        """Whether some tick of it is behind `before` and not behind `instant`."""
        return self.first <= instant and (before is None or before < self.last)

    def hides(self, instant: int) -> bool:
        """Whether what was read at an instant of it may have been followed by what was lost.

        What bears the last stamp ended the outage, so it came last. Of an outage that is but one
        instant nobody can say that: what was read there may have come before and behind it.
        """
        return self.covers(instant) and not self.first < instant == self.last


class Truth(IntEnum):
    """The truth of a formula at a position."""

    FALSE = 0
    UNKNOWN = 1
    TRUE = 2
    UNBORN = 3
    """The truth of formulas of the present and past over signals without a value so far."""


_NEGATION = (Truth.TRUE, Truth.UNKNOWN, Truth.FALSE, Truth.UNBORN)
_FALSE_FIRST = (0, 1, 3, 2)
_TRUE_FIRST = (3, 1, 0, 2)
"""By truth, its place: of several, the first counts."""


def negation(value: Truth) -> Truth:
    """TRUE and FALSE exchanged.

    >>> negation(Truth.UNKNOWN).name
    'UNKNOWN'
    """
    return _NEGATION[value]


def conjunction(values: Iterable[Truth]) -> Truth:
    """FALSE if any is, else UNKNOWN if any is, else UNBORN if any is; of nothing TRUE.

    >>> conjunction([Truth.UNBORN, Truth.TRUE]).name
    'UNBORN'
    >>> conjunction([Truth.UNBORN, Truth.UNKNOWN]).name
    'UNKNOWN'
    """
    return min(values, key=_FALSE_FIRST.__getitem__, default=Truth.TRUE)


def disjunction(values: Iterable[Truth]) -> Truth:
    """TRUE if any is, else UNKNOWN if any is, else UNBORN if any is; of nothing FALSE."""
    return min(values, key=_TRUE_FIRST.__getitem__, default=Truth.FALSE)


def both(truth: Truth, other: Truth) -> Truth:
    """The conjunction of two, as quickly as it goes."""
    return truth if _FALSE_FIRST[truth] <= _FALSE_FIRST[other] else other


def either(truth: Truth, other: Truth) -> Truth:
    """The disjunction of two, as quickly as it goes."""
    return truth if _TRUE_FIRST[truth] <= _TRUE_FIRST[other] else other


def truth_of(value: bool) -> Truth:
    """TRUE or FALSE."""
    return Truth.TRUE if value else Truth.FALSE


def born_or_true(value: Truth) -> Truth:
    """TRUE in place of UNBORN."""
    return Truth.TRUE if value is Truth.UNBORN else value


def born_or_false(value: Truth) -> Truth:
    """FALSE in place of UNBORN."""
    return Truth.FALSE if value is Truth.UNBORN else value


@dataclass(frozen=True, slots=True)
class Update:
    """One entry for a signal in a sample; `value` is `None` for NaN as well."""

    t: int
    value: Scalar


@dataclass(frozen=True, slots=True)
class SignalState:
    """The state of a signal at a position, as far as it is known.

    Attributes:
        value: the held one; `None` if unknown for whatever reason.
        updated: whether an update falls to this position; unknown of a name without a source.
        changed: whether an update to another value does.
        last: the last update so far.
        before: the one before that.
        born: whether an update has brought a known value so far, or may have in an outage.
        moved: whether one came after the first that did, or may have.
        lost: whether an outage hides what the value is.
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
    """An event at a position: surely there, surely not, or not known; with its payload."""

    truth: Truth
    payload: Payload


@dataclass(frozen=True, slots=True)
class EventState:
    """The state of an event at a position, as far as it is known.

    Attributes:
        updated: whether it was reported, as occurring or not.
        occurrences: the certain and the possible ones.
        lost: the number of them that stand for lost ones.
    """

    updated: Truth = Truth.FALSE
    occurrences: tuple[Occurrence, ...] = ()
    lost: int = 0


@dataclass(frozen=True, slots=True)
class Letter:
    """One position: its instant and the state of every declared name there.

    Attributes:
        instant: ticks.
        signals: the state of each.
        events: the state of each.
        sure: whether there is such a position; in an outage of sampled time, and before the first
            sample that was read, there may be none.
        since: the first position; `None` if it is not known.
    """

    instant: int
    signals: Mapping[str, SignalState]
    events: Mapping[str, EventState]
    sure: bool = True
    since: int | None = None


@dataclass(frozen=True, slots=True)
class Word:
    """All positions of a trace, and how far it is known.

    Attributes:
        letters: one per position; instants increase strictly.
        end: the last instant whose letter is known; `None` before the first sample.
        reached: an instant that time is known to have come to.
    """

    letters: tuple[Letter, ...]
    end: int | None
    reached: int


class Rest(Enum):
    """Assumptions about the part of an operator beyond the known positions."""

    UNKNOWN = auto()
    """Nothing: the truth after a prefix."""

    END = auto()
    """The trace has ended: an unbounded `always` that has begun counts as TRUE."""

    WEAK = auto()
    """All that is pending counts as TRUE."""

    STRONG = auto()
    """All that is pending counts as FALSE."""


def probed(probe: Probe, name: str, letter: Letter) -> Truth:
    """Whether a name was updated, changed, or is known at a position."""
    if name in letter.events:
        event = letter.events[name]
        if probe is Probe.UPDATED:
            return event.updated
        raise ValueError(f"`{probe}({name})`: only `updated` speaks of events")
    signal = letter.signals[name]
    match probe:
        case Probe.UPDATED:
            return signal.updated
        case Probe.KNOWN:
            return Truth.UNKNOWN if signal.lost else truth_of(signal.value is not None)
        case Probe.CHANGED:
            return signal.changed
