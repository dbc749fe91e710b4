"""Runs of a network: symbolic, with the exact window of each wait, and with concrete times.

All runs along a path are the solutions of `t[q] − t[p] <= bound`. To close them all takes the cube
of the path's length. But an instant matters only until no later constraint speaks of it: the path
is gone along once with the closed constraints of those that still matter, and once back with what
the rest asks of them; where both meet stands what all of them imply.

Source: Dechter, Meiri, Pearl, Temporal Constraint Networks, 1991; Dechter, Bucket Elimination: A
Unifying Framework for Reasoning, 1999 (one bucket for each instant).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from fractions import Fraction
from functools import cached_property
from math import inf
from typing import TYPE_CHECKING

from rvmon.models.network import Edge

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Window:
    """A range of durations in units of the model; `high` is `None` if it has no end."""

    low: int
    high: int | None
    low_strict: bool = False
    high_strict: bool = False

    def __contains__(self, duration: Fraction | int) -> bool:
        above = duration > self.low if self.low_strict else duration >= self.low
        if self.high is None:
            return above
        return above and (duration < self.high if self.high_strict else duration <= self.high)


@dataclass(frozen=True, slots=True)
class Action:
    """Edges that are taken together, each with the index of its automaton, the sender first."""

    edges: tuple[tuple[int, Edge], ...]


@dataclass(frozen=True, slots=True)
class Position:
    """The discrete state of a run between two actions: locations and values of variables."""

    locations: tuple[int, ...]
    values: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class RunStep:
    """A wait, and the action behind it."""

    window: Window  # the bounds of the wait, over all runs along this path
    delay: Fraction  # the wait in the concrete run
    # taken then; `None` at the end of a run, or where nothing is done but the query's formula
    # changes its truth
    action: Action | None
    position: Position  # the state after the action


class Ending(StrEnum):
    """The ways in which a run ends."""

    REACHED = "reached"  # the run reaches the goal of the search
    DEADLOCK = "deadlock"  # no edge can be taken any more; time can pass for ever
    TIME_LOCK = "time-lock"  # no edge can be taken any more, and time stops
    IDLE = "idle"  # the run can stay in its last state for ever
    LOOP = "loop"  # the run can repeat its loop for ever, and time diverges
    ZENO_LOOP = "zeno loop"  # the run can repeat its loop for ever, but time converges


@dataclass(frozen=True, slots=True)
class Run:
    """A path of the network and one way to run along it."""

    start: Position  # its initial state
    steps: tuple[RunStep, ...]  # in order
    ending: Ending = Ending.REACHED  # the way it ends
    loop: int | None = None  # for loops the number of the first step that is repeated
    # all timed runs along the path, if it is known
    timing: Timing | None = field(default=None, compare=False, repr=False)

    @property
    def duration(self) -> Fraction:
        """The sum of all delays of the concrete run."""
        return sum((step.delay for step in self.steps), Fraction(0))


Atom = tuple[int, int, float]
"""`(x, y, bound)`: clock y − clock x is at most the bound; clock 0 is always 0."""

STRICT = 2.0**-12  # the difference between a strict bound and the number it is written with

Zone = list[float]
"""Clock valuations by their bounds: of `dim` clocks `dim²`, as an atom's at `x * dim + y`."""


def bound_of(number: int, strict: bool) -> float:
    """The bound `<= number`, or `< number` if strict."""
    return number - STRICT if strict else float(number)


Constraint = tuple[int, int, float]  # `(p, q, bound)`: `t[q] − t[p] <= bound`, in grid steps


@dataclass(frozen=True, slots=True)
class Bag:
    """Constraints between some instants; float64[n, n], entry (p, q) as in `Constraint`, closed."""

    instants: tuple[int, ...]
    bounds: NDArray[np.float64]

    def kept(self, instants: Iterable[int]) -> Bag:
        """The bag restricted to some instants."""
        import numpy as np

        chosen = tuple(sorted(instants))
        places = [self.instants.index(one) for one in chosen]
        return Bag(chosen, self.bounds[np.ix_(places, places)])

    def of(self, first: int, second: int) -> float:
        """The bound on `t[second] − t[first]`."""
        return float(self.bounds[self.instants.index(first), self.instants.index(second)])


def _together(
    instants: Iterable[int], parts: Iterable[Bag], constraints: Iterable[Constraint] = ()
) -> Bag:
    """All that some bags and constraints imply of some instants."""
    import numpy as np

    chosen = tuple(sorted(instants))
    place = {one: number for number, one in enumerate(chosen)}
    bounds = np.full((len(chosen), len(chosen)), inf)
    np.fill_diagonal(bounds, 0.0)
    for part in parts:
        own = np.ix_(*[[place[instant] for instant in part.instants]] * 2)
        bounds[own] = np.minimum(bounds[own], part.bounds)
    for first, second, bound in constraints:
        at = place[first], place[second]
        bounds[at] = min(bounds[at], bound)
    close(bounds)
    return Bag(chosen, bounds)


def close(bounds: NDArray[np.float64]) -> None:
    """Tighten all bounds to those that they imply together, in place."""
    import numpy as np

    for middle in range(len(bounds)):
        np.minimum(bounds, bounds[:, middle, None] + bounds[None, middle, :], out=bounds)


class Timing:
    """The timed runs along a path.

    Args:
        constraints: those of the start, then for each instant from 1 on those that come with it,
            which speak of no later one.
        others: number of instants before the start; they are counted behind the last one.
        scale: grid steps in one unit of time.
    """

    def __init__(
        self, constraints: Sequence[Sequence[Constraint]], others: int, scale: int
    ) -> None:
        self.scale = scale
        self._constraints = constraints
        self._last = len(constraints) - 1
        self._always = {0, *range(self._last + 1, self._last + 1 + others)}

    @cached_property
    def is_possible(self) -> bool:
        """Whether there is a run."""
        return all((bag.bounds.diagonal() >= 0).all() for bag in self._forward(()))

    @cached_property
    def waits(self) -> list[tuple[float, float, float]]:
        """The least and greatest wait before each instant, and the earliest that it can be at."""
        found, live = [], self._live()
        later = _together(live[-1], ())
        for now, before in reversed([*enumerate(self._forward(()), start=1)]):
            whole = _together(before.instants, (before, later))
            found.append((-whole.of(now, now - 1), whole.of(now - 1, now), -whole.of(now, 0)))
            own = self._constraints[now]
            both = {*later.instants, *live[now - 1], now}
            later = _together(both, (later,), own).kept(live[now - 1])
        return found[::-1]

    def relation(self, instants: Sequence[int]) -> NDArray[np.float64]:
        """float64[n, n] grid steps: `t[q] − t[p]` at (p, q), of some instants in their order."""
        import numpy as np

        *_, last = self._forward(instants)
        places = [last.instants.index(instant) for instant in instants]
        return last.bounds[np.ix_(places, places)]

    def _forward(self, keep: Iterable[int]) -> Iterator[Bag]:
        """At each instant all that those up to it imply of those that still matter."""
        live = self._live()
        bag = _together(live[0], (), self._constraints[0])
        for now in range(1, self._last + 1):
            bag = _together({*bag.instants, now}, (bag,), self._constraints[now])
            yield bag
            bag = bag.kept(live[now] | ({*keep} & {*bag.instants}))

    def _live(self) -> list[set[int]]:
        """For each instant those up to it of which later constraints speak, and always some."""
        live = [self._always | {now} for now in range(self._last + 1)]
        needed: set[int] = set()
        for now in range(self._last, 0, -1):
            needed |= {
                one for first, second, _ in self._constraints[now] for one in (first, second)
            }
            needed.discard(now)
            live[now - 1] |= needed
        return live
