"""A trace as a word: one letter per position, with all that the propositions can read there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rvmon.testing.law.kleene import Truth
from rvmon.trace.sample import Payload, Scalar


@dataclass(frozen=True, slots=True)
class Update:
    """One entry for a signal in a sample; `value` is `None` for NaN as well."""

    t: int
    value: Scalar


@dataclass(frozen=True, slots=True)
class SignalState:
    """What is known of a signal at a position.

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
    """What is known of an event at a position."""

    updated: Truth = Truth.FALSE
    occurrences: tuple[Occurrence, ...] = ()


@dataclass(frozen=True, slots=True)
class Letter:
    """One position: its instant and the state of every declared name there.

    Attributes:
        instant: ticks.
        signals: the state of each.
        events: the state of each.
        sure: whether there is such a position; in an outage of sampled time, and before the first
            sample that was read, there may be none.
    """

    instant: int
    signals: Mapping[str, SignalState]
    events: Mapping[str, EventState]
    sure: bool = True


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
