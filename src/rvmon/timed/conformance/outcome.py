"""What holding a recorded run against a network gives."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Recorded:
    """An action of a recording: its label, and its instant in ticks since the start."""

    t: int
    label: str


@dataclass(frozen=True, slots=True)
class Allowed:
    """What a network would have allowed instead.

    Attributes:
        label: of an action; empty: nothing more until the end of the recording.
        earliest: ticks since the start.
        latest: ticks; `None` if it has no end.
    """

    label: str
    earliest: int
    latest: int | None


@dataclass(frozen=True, slots=True)
class Divergence:
    """Where a recording leaves the network's runs.

    Attributes:
        at: ticks since the start.
        label: the action that no run can do then; empty: the recording ends, but every run would
            have done something before.
        allowed: what some run could have done after the actions before.
    """

    at: int
    label: str
    allowed: tuple[Allowed, ...]


@dataclass(frozen=True, slots=True)
class Conformance:
    """The answer for one recording.

    Attributes:
        explained: actions that some run of the network does at these instants.
        divergence: the first that none does; `None` if the recording conforms.
        undecided: which budget ended the search; empty if it was done.
    """

    explained: int
    divergence: Divergence | None
    undecided: str = ""

    @property
    def conforms(self) -> bool | None:
        """Whether some run explains the whole recording; `None` if that was not decided."""
        return None if self.undecided else self.divergence is None
