"""Open attempts of one requirement as arrays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.monitor.columns.axis import FAR
from rvmon.monitor.columns.tables import Table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]


@dataclass(slots=True, eq=False)
class Tokens(Table):
    """Where attempts are; all arrays have an entry per attempt.

    Attributes:
        location: of the automaton.
        anchor: the instant at which the clock was started.
        region: of the clock, as far as time has come.
        place: the position up to which it was driven.
    """

    location: Numbers
    anchor: Numbers
    region: Numbers
    place: Numbers

    def __len__(self) -> int:
        return len(self.place)

    def copy(self) -> Tokens:
        """The same, independent from now on."""
        return self.pick(np.arange(len(self)))

    def differ(self, other: Tokens) -> NDArray[np.bool_]:
        """Which attempts are not where those of the other are."""
        made: NDArray[np.bool_] = (
            (self.location != other.location)
            | (self.anchor != other.anchor)
            | (self.region != other.region)
            | (self.place != other.place)
        )
        return made

    def put(self, which: Any, others: Tokens) -> None:
        """Replace some of them."""
        self.location[which], self.anchor[which] = others.location, others.anchor
        self.region[which], self.place[which] = others.region, others.place


def starting(initial: int, places: Numbers) -> Tokens:
    """Attempts that start at these places."""
    none = np.zeros(len(places), np.int64)
    return Tokens(none + initial, none.copy(), none.copy(), places - 1)


@dataclass(slots=True, eq=False)
class Attempts(Table):
    """Attempts; all arrays have an entry for each.

    Attributes:
        start: the place at which it starts.
        stop: the place behind its episode; `FAR` as long as that runs.
        triggered: the instant of its trigger, ticks.
        seen: what was read there, packed.
        number: among those that are sure; 0 if it is in doubt.
        doubtful: its number among those whose trigger was not true at first; 0 for the others.
        void: whether it cannot pass, since its episode was over before all was born.
        doubted: when unknown input made the two runs part.
        doubt_seen: what was read there, packed.
        worse: where the run is that takes the unknown for the worse.
        better: the same for the better; `None` if all are where the others are.
    """

    start: Numbers
    stop: Numbers
    triggered: Numbers
    seen: Numbers
    number: Numbers
    doubtful: Numbers
    void: NDArray[np.bool_]
    doubted: Numbers
    doubt_seen: Numbers
    worse: Tokens
    better: Tokens | None = None

    def __len__(self) -> int:
        return len(self.start)


def joined_attempts(parts: Sequence[Attempts]) -> Attempts:
    """The attempts of all parts, in their order; there is one."""
    if any(part.better is not None for part in parts):
        parts = [replace(part, better=part.better or part.worse.copy()) for part in parts]
    return Attempts.joined(parts)


def starting_attempts(
    initial: int, places: Numbers, stop: Numbers, triggered: Numbers, seen: Numbers
) -> Attempts:
    """Attempts that start, without numbers.

    Args:
        initial: the location before them.
        places: of the triggers.
        stop: see `Attempts`; so are the others.
        triggered: ticks.
        seen: packed.
    """
    count = len(places)
    return Attempts(
        places,
        stop,
        triggered,
        seen,
        np.zeros(count, np.int64),
        np.zeros(count, np.int64),
        np.zeros(count, bool),
        np.full(count, FAR),
        seen.copy(),
        starting(initial, places),
    )
