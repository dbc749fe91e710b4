"""The problems of leads-to: find where the left side holds and the right side need not come."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil

from rvmon.timed.model.expressions import BinaryOperation, Expression
from rvmon.timed.model.guards import normal_form
from rvmon.timed.model.network import Network
from rvmon.timed.model.operators import BinaryOp
from rvmon.timed.search.liveness import Escape, Staying
from rvmon.timed.search.meter import Meter
from rvmon.timed.zones.dbm import STRICT, Zone, cut, reset, zero
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.stay import Crossing, Inside, StaySite
from rvmon.timed.zones.symbolic import Steps, meets
from rvmon.timed.zones.zone_unions import EVERYWHERE, Constraint, constraint_maker


class UnboundedResponse(Steps):
    """Find where `left` holds and from where a run need never meet `right`.

    Sites are discrete states, links are moves.

    Args:
        network: where to look.
        left: normalised.
        right: normalised.
        meter: counts the states on the way from there too.
        proper_only: whether a way counts only if time passes on it without bound.

    Attributes:
        staying: the search from there.
        escape: the way found; `None` while there is none.
    """

    def __init__(
        self,
        network: Network,
        left: Expression,
        right: Expression,
        meter: Meter,
        *,
        proper_only: bool,
    ) -> None:
        super().__init__(network, BinaryOperation(BinaryOp.AND, left, right), bisimilar=True)
        self.inside = Inside(self.space, constraint_maker(normal_form(right, positive=False)))
        self.staying = Staying(self.inside, meter, proper_only=proper_only)
        self.escape: Escape | None = None
        self._left = constraint_maker(left)

    def goal(self, site: State, zone: Zone) -> Constraint | None:
        """Where `left` holds in the zone, if `right` need never come from there."""
        for constraint in self._left(site.vector.locations, site.values):
            triggered = zone[:]
            if cut(triggered, self.dim, constraint):
                for stand in self.inside.enter(site, triggered):
                    self.escape = self.staying.find(stand)
                    if self.escape is not None:
                        return (*constraint, *stand.site.constraint)
        return None


BoundedSite = State | StaySite
BoundedLink = Move | Crossing | Constraint
"""A move, a crossing, or the instant at which `left` held and the time began to count."""


class BoundedResponse:
    """Find a run on which `left` holds, and then `right` not within a bound.

    A clock of the query, the last one, starts where `left` holds; sites are discrete states before
    and pieces of `not right` after.

    Args:
        network: where to look.
        left: normalised; `None`: the time counts from the start of the run, and only from there.
        right: normalised.
        bound: units of time.
    """

    def __init__(
        self, network: Network, left: Expression | None, right: Expression, bound: int
    ) -> None:
        both = right if left is None else BinaryOperation(BinaryOp.AND, left, right)
        self.steps = Steps(network, both, observers=1)
        self.dim = self.steps.dim
        self.timer = self.dim - 1
        constraints = constraint_maker(normal_form(right, positive=False))
        self.inside = Inside(self.steps.space, constraints, [(self.timer, float(bound))])
        self._left = None if left is None else constraint_maker(left)
        self._bound = bound

    def start(self) -> Iterator[tuple[BoundedSite, Zone]]:
        """The initial state."""
        if self._left is not None:
            yield from self.steps.start()
            return
        state = self.steps.space.initial()
        if state is not None:
            for stand in self.inside.enter(state, zero(self.dim)):
                yield stand.site, stand.zone

    def successors(
        self, site: BoundedSite, zone: Zone
    ) -> Iterator[tuple[BoundedLink, BoundedSite, Zone]]:
        """All moves, and where the time begins to count."""
        if isinstance(site, StaySite):
            yield from (
                (crossing, crossing.target, behind)
                for crossing, behind in self.inside.crossed(site, zone)
            )
            for move, stand in self.inside.moved(site, zone):
                yield move, stand.site, stand.zone
            return
        yield from self.steps.successors(site, zone)
        assert self._left is not None  # noqa: S101 - else no site is a discrete state
        for constraint in self._left(site.vector.locations, site.values):
            triggered = zone[:]
            if cut(triggered, self.dim, constraint):
                reset(triggered, self.dim, self.timer, 0.0)
                for stand in self.inside.enter(site, triggered):
                    yield (*constraint, *stand.site.constraint), stand.site, stand.zone

    def goal(self, site: BoundedSite, zone: Zone) -> Constraint | None:
        """Where the bound is over, or is just met while time goes on."""
        if not isinstance(site, StaySite):
            return None
        late: Constraint = (*site.constraint, (self.timer, 0, -self._bound - STRICT))
        if meets(zone, self.dim, late):
            return late
        if site.constraint == EVERYWHERE or not site.state.delays:
            return None
        # `right` comes as soon as the bound is over: too late, if time can go on at the bound.
        due: Constraint = (
            *site.constraint,
            (self.timer, 0, -float(self._bound)),
            *((0, clock, _below(bound)) for clock, bound in site.state.invariant),
        )
        return due if meets(zone, self.dim, due) else None


def _below(bound: float) -> float:
    """The strict form of a bound."""
    return float(ceil(bound)) - STRICT
