"""The problem of reaching a state formula."""

from __future__ import annotations

from math import inf

from rvmon.timed.model.expressions import Expression
from rvmon.timed.model.guards import with_deadlock
from rvmon.timed.model.network import Network
from rvmon.timed.runs.run import Ending
from rvmon.timed.zones.dbm import Zone, cut, normalise
from rvmon.timed.zones.deadlock import Deadlocks, is_time_bounded
from rvmon.timed.zones.discrete import State
from rvmon.timed.zones.federation import constraint_of, subtract_all, universe
from rvmon.timed.zones.symbolic import Steps, meets
from rvmon.timed.zones.zone_unions import Constraint, constraint_maker


class Reachability(Steps):
    """Reach a formula without `deadlock`; sites are discrete states, links are moves.

    Args:
        network: where to look.
        formula: normalised.
        within: units of time since the start; `None`: whenever.
        timed: whether the last clock measures the time since the start, and a state that is
            reached later never covers one that is reached earlier.

    Attributes:
        timer: the last clock, if there is a bound or `timed`.
    """

    def __init__(
        self,
        network: Network,
        formula: Expression,
        *,
        within: int | None = None,
        timed: bool = False,
    ) -> None:
        self.timer = 1 + len(network.clocks)
        uppers = [(self.timer, -inf if timed else -float(within or 0))]
        if not timed and within is None:
            uppers = []
        super().__init__(network, formula, len(uppers), uppers)
        self._constraints = constraint_maker(formula)
        self._due: Constraint = () if within is None else ((0, self.timer, float(within)),)
        self._goals: dict[State, list[Constraint]] = {}

    def goal(self, site: State, zone: Zone) -> Constraint | None:
        """The first piece of the formula that meets the zone."""
        constraints = self._goals.get(site)
        if constraints is None:
            found = self._constraints(site.vector.locations, site.values)
            constraints = self._goals[site] = [(*constraint, *self._due) for constraint in found]
        return next(
            (constraint for constraint in constraints if meets(zone, self.dim, constraint)), None
        )


class DeadlockReachability(Steps):
    """Reach a formula that speaks of `deadlock`; sites are discrete states, links are moves.

    A state that can do more than another may be alive where that is dead, so only states that can
    do the same stand for each other.

    Args:
        network: where to look.
        formula: normalised.
        within: units of time since the start; `None`: whenever.
    """

    def __init__(self, network: Network, formula: Expression, *, within: int | None) -> None:
        timer = 1 + len(network.clocks)
        bounds = [] if within is None else [(timer, float(within))]
        uppers = [(clock, -bound) for clock, bound in bounds]
        super().__init__(network, formula, len(bounds), uppers, bounds, bisimilar=True)
        self._due: Constraint = tuple((0, clock, bound) for clock, bound in bounds)
        self._deadlocks = Deadlocks(self.space)
        self._if_dead = constraint_maker(with_deadlock(formula, value=True))
        self._if_alive = constraint_maker(with_deadlock(formula, value=False))

    def goal(self, site: State, zone: Zone) -> Constraint | None:
        """A part of the zone where the formula holds."""
        locations, values = site.vector.locations, site.values
        dead_pieces = self._if_dead(locations, values)
        alive_pieces = self._if_alive(locations, values)
        if not (dead_pieces or alive_pieces):
            return None
        dead = self._deadlocks.dead(site, zone)
        alive = subtract_all([zone], dead, self.dim) if alive_pieces else []
        for parts, constraints in ((dead, dead_pieces), (alive, alive_pieces)):
            for part in parts:
                for constraint in constraints:
                    due = (*constraint, *self._due)
                    if meets(part, self.dim, due):
                        return (*due, *constraint_of(part, self.dim))
        return None

    def ending(self, site: State, constraint: Constraint) -> Ending:
        """How a run ends that reaches a part of a state's valuations."""
        part = universe(self.dim)
        cut(part, self.dim, constraint)
        if not self._deadlocks.dead(site, normalise(part)):
            return Ending.REACHED
        return Ending.TIME_LOCK if is_time_bounded(site) else Ending.DEADLOCK
