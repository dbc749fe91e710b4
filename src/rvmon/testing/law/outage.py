"""Stretches of time over which a source may have said anything."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Outage:
    """What was lost of some names, nobody knows what or how much of it.

    The trace reaches to its last instant: that time went on is not among what was lost. Of a
    source that is lost for good the door says how far time is known to have come.

    Attributes:
        names: of the signals and events that may have said anything; there may be none, as a line
            that says nothing is a position of sampled time all the same.
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
