"""What a timeline shows of one signal or event: data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from rvmon.trace.sample import Scalar


class TrackKind(StrEnum):
    """How a track is drawn."""

    SWITCH = "switch"
    EVENT = "event"
    NUMBER = "number"
    LABEL = "label"


@dataclass(frozen=True, slots=True)
class Threshold:
    """A constant that the requirement compares the signal with, in the signal's unit."""

    op: str
    value: float


@dataclass(frozen=True, slots=True)
class Track:
    """One signal or event over a run.

    Attributes:
        name: as declared.
        kind: how to draw it.
        changes: `(ticks, value)` in order: from then on a signal has the value (`None`:
            unknown); an event occurred then (`None`: nobody knows whether).
        unit: of a number.
        thresholds: that the requirement compares it with.
        absent: whether it has no source at all, so that nothing is known of it.
    """

    name: str
    kind: TrackKind
    changes: tuple[tuple[int, Scalar], ...]
    unit: str = ""
    thresholds: tuple[Threshold, ...] = ()
    absent: bool = False

    def value_at(self, instant: int) -> Scalar:
        """A signal's value at an instant; `None` where it is unknown."""
        from bisect import bisect_right

        index = bisect_right(self.changes, instant, key=lambda change: change[0])
        return self.changes[index - 1][1] if index else None
