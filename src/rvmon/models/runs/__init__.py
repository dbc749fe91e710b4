"""Runs of a network: a path with the exact window of each wait, and with concrete times.

The runs along a path are the solutions of constraints `t[q] − t[p] <= bound`. Closing all these
constraints takes time cubic in the length of the path. However, an instant matters only as long as
later constraints refer to it. A forward pass keeps the closed constraints between the instants that
still matter, and a backward pass adds what the later constraints require. Where the passes meet
they give everything that the constraints imply together.

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
    """A range of durations in units of the model. `high` is `None` if there is no upper end."""

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
    """Edges taken together, each with the index of its automaton. The sender comes first."""

    edges: tuple[tuple[int, Edge], ...]


@dataclass(frozen=True, slots=True)
class Position:
    """The discrete state of a run between two actions: locations and values of variables."""

    locations: tuple[int, ...]
    values: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class RunStep:
    """A wait and the action after it."""

    window: Window  # the bounds of the wait, over all runs along this path
    delay: Fraction  # the wait in the concrete run
    # the action after the wait; `None` at the end of a run, or where no edge is taken but the
    # formula of the query changes its truth
    action: Action | None
    position: Position  # the state after the action


class Ending(StrEnum):
    """The ways in which a run ends."""

    REACHED = "reached"  # the run reaches the goal of the search
    DEADLOCK = "deadlock"  # no edge can be taken any more; time can pass forever
    TIME_LOCK = "time-lock"  # no edge can be taken any more, and time stops
    IDLE = "idle"  # the run can stay in its last state forever
    LOOP = "loop"  # the run can repeat its loop forever, and time diverges
    ZENO_LOOP = "zeno loop"  # the run can repeat its loop forever, but time converges


@dataclass(frozen=True, slots=True)
class Run:
    """A path of the network and one concrete run along it."""

    start: Position
    steps: tuple[RunStep, ...]  # in order
    ending: Ending = Ending.REACHED
    loop: int | None = None  # the index of the first step that is repeated; `None` without a loop
    # all timed runs along the path, if they are known
    timing: Timing | None = field(default=None, compare=False, repr=False)

    @property
    def duration(self) -> Fraction:
        """The sum of all delays of the concrete run."""
        return sum((step.delay for step in self.steps), Fraction(0))


Atom = tuple[int, int, float]
"""`(x, y, bound)`: clock y − clock x is at most the bound. Clock 0 is always 0."""

STRICT = 2.0**-12  # how far a strict bound lies below its number

Zone = list[float]
"""Clock valuations given by `dim²` bounds: entry `x * dim + y` is the bound of an atom."""


def bound_of(number: int, strict: bool) -> float:
    """The bound `<= number`, or `< number` if strict."""
    return number - STRICT if strict else float(number)


Constraint = tuple[int, int, float]  # `(p, q, bound)`: `t[q] − t[p] <= bound`, in grid steps


@dataclass(frozen=True, slots=True)
class Bag:
    """Closed constraints between some instants: float64[n, n], with (p, q) as in `Constraint`."""

    instants: tuple[int, ...]
    bounds: NDArray[np.float64]

    def kept(self, instants: Iterable[int]) -> Bag:
        """The bag restricted to some of its instants."""
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
    """Everything that some bags and constraints imply for the given instants."""
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
    """Tighten all bounds to those that they imply together, in place (Floyd-Warshall)."""
    import numpy as np

    for middle in range(len(bounds)):
        np.minimum(bounds, bounds[:, middle, None] + bounds[None, middle, :], out=bounds)


class Timing:
    """The timed runs along a path.

    Args:
        constraints: first those of the start, then for each instant from 1 on those that arise with
            it, which refer to no later one.
        others: number of instants before the start; they are numbered after the last instant.
        scale: number of grid steps per unit of time.
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
        """Whether any run exists."""
        return all((bag.bounds.diagonal() >= 0).all() for bag in self._forward(()))

    @cached_property
    def waits(self) -> list[tuple[float, float, float]]:
        """The least and greatest wait before each instant, and its earliest time."""
        found, live = [], self._live()
        later = _together(live[-1], ())  # what the constraints after `now` imply
        for now, before in reversed([*enumerate(self._forward(()), start=1)]):
            whole = _together(before.instants, (before, later))
            found.append((-whole.of(now, now - 1), whole.of(now - 1, now), -whole.of(now, 0)))
            own = self._constraints[now]
            both = {*later.instants, *live[now - 1], now}
            later = _together(both, (later,), own).kept(live[now - 1])
        return found[::-1]

    def relation(self, instants: Sequence[int]) -> NDArray[np.float64]:
        """The bounds on `t[q] − t[p]` at (p, q): float64[n, n] grid steps, in the given order."""
        import numpy as np

        *_, last = self._forward(instants)
        places = [last.instants.index(instant) for instant in instants]
        return last.bounds[np.ix_(places, places)]

    def _forward(self, keep: Iterable[int]) -> Iterator[Bag]:
        """For each instant, what the constraints up to it imply for the instants still needed."""
        live = self._live()
        bag = _together(live[0], (), self._constraints[0])
        for now in range(1, self._last + 1):
            bag = _together({*bag.instants, now}, (bag,), self._constraints[now])
            yield bag
            bag = bag.kept(live[now] | ({*keep} & {*bag.instants}))

    def _live(self) -> list[set[int]]:
        """For each instant, the ones up to it in later constraints, the start, and those before."""
        live = [self._always | {now} for now in range(self._last + 1)]
        needed: set[int] = set()
        for now in range(self._last, 0, -1):
            needed |= {
                one for first, second, _ in self._constraints[now] for one in (first, second)
            }
            needed.discard(now)
            live[now - 1] |= needed
        return live
