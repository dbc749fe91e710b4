"""Runs that stay inside a state formula: the part of the network that such runs see.

A formula with clocks holds on a union of convex pieces in each discrete state; a run stays inside
one piece while it waits there, and may cross from one piece to the next while time passes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil

from rvmon.timed.zones.dbm import Zone, cut, delay, normalise
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.successors import Space
from rvmon.timed.zones.symbolic import fire, settle_in
from rvmon.timed.zones.zone_unions import EVERYWHERE, Constraint, ConstraintMaker


@dataclass(frozen=True, slots=True, eq=False)
class StaySite:
    """A discrete state and one piece of the formula; one object for each."""

    state: State
    constraint: Constraint
    uppers: Sequence[tuple[int, float]]
    lowers: Sequence[tuple[int, float]]


@dataclass(frozen=True, slots=True, eq=False)
class Crossing:
    """From one piece to another at one instant.

    Attributes:
        leave: what holds then of the piece that is left.
        enter: what holds then of the piece that is entered.
        target: the site behind.
    """

    leave: Constraint
    enter: Constraint
    target: StaySite


@dataclass(slots=True, eq=False)
class Stride:
    """Some crossings, and then a move."""

    crossings: tuple[Crossing, ...]
    move: Move


@dataclass(slots=True, eq=False)
class Stand:
    """Where a run can be without a further move: a site, its zone, the crossings that led there."""

    site: StaySite
    zone: Zone
    crossings: tuple[Crossing, ...] = ()


class Inside:
    """The network as runs see it that never leave a formula."""

    def __init__(
        self, space: Space, constraints: ConstraintMaker, lowers: Sequence[tuple[int, float]] = ()
    ) -> None:
        self.space = space
        self._constraints = constraints
        self._lowers = tuple(lowers)
        self._sites: dict[State, list[StaySite]] = {}
        self._crossings: dict[StaySite, list[Crossing]] = {}

    def sites(self, state: State) -> list[StaySite]:
        """The pieces of the formula in a state."""
        sites = self._sites.get(state)
        if sites is None:
            sites = self._sites[state] = [
                StaySite(state, constraint, state.uppers, (*state.lowers, *self._lowers))
                for constraint in self._constraints(state.vector.locations, state.values)
            ]
        return sites

    def enter(self, state: State, zone: Zone) -> Iterator[Stand]:
        """Where valuations of a state, just reached, can be while they stay inside."""
        for site in self.sites(state):
            inside = self.settle(site, zone)
            if inside is not None:
                yield Stand(site, inside)

    def settle(self, site: StaySite, zone: Zone) -> Zone | None:
        """The part of a zone in a piece, with the delays that stay in it; `None` if empty."""
        dim, state = self.space.dim, site.state
        inside = zone[:]
        if site.constraint == EVERYWHERE:
            return normalise(inside) if settle_in(state, inside, dim) else None
        invariant = [(0, clock, bound) for clock, bound in state.invariant]
        if not (cut(inside, dim, site.constraint) and cut(inside, dim, invariant)):
            return None
        if state.delays:
            delay(inside, dim)
            # A piece is convex, so that who starts and ends a wait in it never left it.
            if not (cut(inside, dim, invariant) and cut(inside, dim, site.constraint)):
                return None
        return normalise(inside)

    def stands(self, stand: Stand) -> Iterator[Stand]:
        """A stand and all that crossings make of it."""
        pending = [stand]
        while pending:
            here = pending.pop()
            yield here
            # A run is in a convex piece for one stretch of time, so it never comes back.
            been = {stand.site, *(crossing.target for crossing in here.crossings)}
            for crossing, zone in self.crossed(here.site, here.zone):
                if crossing.target not in been:
                    pending.append(Stand(crossing.target, zone, (*here.crossings, crossing)))

    def crossed(self, site: StaySite, zone: Zone) -> Iterator[tuple[Crossing, Zone]]:
        """What each crossing makes of a site's zone."""
        for crossing in self._crossings_from(site):
            behind = self._cross(site, crossing, zone)
            if behind is not None:
                yield crossing, behind

    def moved(self, site: StaySite, zone: Zone) -> Iterator[tuple[Move, Stand]]:
        """What each move makes of a site's zone."""
        for move in self.space.moves(site.state):
            fresh = fire(move, zone, self.space.dim)
            if fresh is not None:
                for stand in self.enter(move.target, fresh):
                    yield move, stand

    def _cross(self, site: StaySite, crossing: Crossing, zone: Zone) -> Zone | None:
        dim, moved = self.space.dim, zone[:]
        delay(moved, dim)
        invariant = [(0, clock, bound) for clock, bound in site.state.invariant]
        parts = (invariant, crossing.leave, crossing.enter)
        if not all(cut(moved, dim, atoms) for atoms in parts):
            return None
        delay(moved, dim)
        if not (cut(moved, dim, invariant) and cut(moved, dim, crossing.target.constraint)):
            return None
        return normalise(moved)

    def strides(self, stand: Stand) -> Iterator[tuple[Stride, Stand]]:
        """All moves that stay inside, each after the crossings it needs."""
        for here in self.stands(stand):
            for move, after in self.moved(here.site, here.zone):
                yield Stride(here.crossings, move), after

    def _crossings_from(self, site: StaySite) -> list[Crossing]:
        crossings = self._crossings.get(site)
        if crossings is None:
            crossings = []
            if site.state.delays and site.constraint != EVERYWHERE:
                for other in self.sites(site.state):
                    if other is not site:
                        # The last instant in the one may be missing, or the first in the other.
                        crossings.append(Crossing(_until(site.constraint), other.constraint, other))
                        crossings.append(Crossing(site.constraint, _since(other.constraint), other))
            self._crossings[site] = crossings
        return crossings


def _until(constraint: Constraint) -> Constraint:
    """A piece with the instants at which time leaves it."""
    return tuple((x, y, float(ceil(b)) if x == 0 else b) for x, y, b in constraint)


def _since(constraint: Constraint) -> Constraint:
    """A piece with the instants behind which time enters it."""
    return tuple((x, y, float(ceil(b)) if y == 0 else b) for x, y, b in constraint)
