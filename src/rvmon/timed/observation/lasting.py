"""Attempts that stay open for ever, on runs on which time passes without end.

Where all that is owed without deadline is that something happens, such a run fails the requirement
though none of its beginnings does. The product of network and monitor is gone through with zones
that are blurred up to bisimulation, and one more clock, which a move sets to 0 where it finds that
a unit of time has passed: time passes without end on a loop if such a move is on it.

Source: Tripakis, Yovine, Bouajjani, Checking Timed Büchi Automata Emptiness Efficiently, 2005.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

from rvmon.formula.core import And, Core, Next, Or, Release, Until
from rvmon.timed.observation.observer import Observed, ObservedLink, ObservedSite, Phase
from rvmon.timed.search.meter import Meter
from rvmon.timed.search.problem import Node
from rvmon.timed.zones.dbm import STRICT, Zone, blurred, constrain, normalise, reset

_Node = Node[ObservedSite, ObservedLink]
_Arc = tuple[int, ObservedLink, bool]


def open_means(owed: Core) -> bool | None:
    """Whether an attempt that stays open for ever is met; `None` if that depends on more.

    Without deadline may be promises (`eventually`), or prohibitions (`always`), but not both.
    """
    match list(_kinds(owed)):
        case []:
            return True
        case [kind]:
            return kind
        case _:
            return None


def _kinds(owed: Core) -> frozenset[bool | None]:
    match owed:
        case And(args=args) | Or(args=args):
            return frozenset().union(*map(_kinds, args))
        case Until(left=left, right=right, high=high):
            own = frozenset({False} if high is None else ())
            return own | _kinds(left) | _kinds(right)
        case Release(left=left, right=right, high=high):
            own = frozenset({True} if high is None else ())
            return own | _kinds(left) | _kinds(right)
        case Next():
            return frozenset({None})
        case _:  # of the present and past
            return frozenset()


class Lasting:
    """Looks for an attempt that stays open for ever.

    Args:
        problem: with the clock `tick`.
        meter: counts the symbolic states.
    """

    def __init__(self, problem: Observed, meter: Meter) -> None:
        self._problem = problem
        self._meter = meter
        self._nodes: list[_Node] = []
        self._arcs: list[list[_Arc]] = []
        self._places: dict[tuple[ObservedSite, tuple[float, ...]], int] = {}

    def find(self) -> tuple[_Node, int | None] | None:
        """The end of such a run and the step at which its loop begins (`None`: it idles there)."""
        pending = deque[int]()
        for site, zone in self._problem.start():
            self._meet(site, zone, None, None, pending)
        while pending:
            place = pending.popleft()
            node = self._nodes[place]
            if self._problem.rests(node.site):
                return node, None
            if not self._meter.count(len(pending)):
                return None
            for link, site, zone in self._problem.successors(node.site, node.zone):
                if site.phase is not Phase.IDLE and site.location < 0:
                    continue  # decided
                for part, tick in self._split(site, zone):
                    to = self._meet(site, part, node, link, pending)
                    self._arcs[place].append((to, link, tick))
        component = self._components()
        for place, arcs in enumerate(self._arcs):
            for to, link, tick in arcs:
                if tick and component[place] == component[to]:
                    return self._round(place, to, link, component)
        return None

    def _split(self, site: ObservedSite, zone: Zone) -> Iterator[tuple[Zone, bool]]:
        """A zone just behind a move, apart: where a unit of time has passed, and where not."""
        dim, tick = self._problem.dim, self._problem.tick
        if site.phase is not Phase.FRESH:
            yield zone, False
            return
        late, soon = zone[:], zone[:]
        if constrain(late, dim, tick, 0, -1.0):
            reset(late, dim, tick, 0.0)
            yield normalise(late), True
        if constrain(soon, dim, 0, tick, 1 - STRICT):
            yield normalise(soon), False

    def _meet(
        self,
        site: ObservedSite,
        zone: Zone,
        parent: _Node | None,
        link: ObservedLink | None,
        pending: deque[int],
    ) -> int:
        zone = blurred(zone, self._problem.dim, self._problem.most(site))
        key = site, tuple(zone)
        place = self._places.get(key)
        if place is None:
            place = self._places[key] = len(self._nodes)
            self._nodes.append(Node(site, zone, parent, link))
            self._arcs.append([])
            pending.append(place)
        return place

    def _round(
        self, place: int, to: int, link: ObservedLink, component: list[int]
    ) -> tuple[_Node, int]:
        """The run to a node and round its component, beginning with an arc."""
        came: dict[int, tuple[int, ObservedLink]] = {}
        pending = deque([to])
        while pending and place != to and place not in came:
            here = pending.popleft()
            for after, step, _ in self._arcs[here]:
                if component[after] == component[to] and after not in came and after != to:
                    came[after] = here, step
                    pending.append(after)
        steps, here = [], place
        while here != to:
            here, step = came[here]
            steps.append(step)
        node = self._nodes[place]
        loop = len(node.path()) - 1
        here, node = to, Node(self._nodes[to].site, self._nodes[to].zone, node, link)
        for step in reversed(steps):
            here = next(after for after, own, _ in self._arcs[here] if own is step)
            node = Node(self._nodes[here].site, self._nodes[here].zone, node, step)
        return node, loop

    def _components(self) -> list[int]:
        """The number of each node's strongly connected component (Tarjan, without recursion)."""
        size = len(self._arcs)
        number, low, component = [0] * size, [0] * size, [-1] * size
        open_nodes: list[int] = []
        count = 0
        for root in range(size):
            frames = [] if number[root] else [(root, iter(self._arcs[root]))]
            while frames:
                place, arcs = frames[-1]
                if not number[place]:
                    count += 1
                    number[place] = low[place] = count
                    open_nodes.append(place)
                for to, _, _ in arcs:
                    if not number[to]:
                        frames.append((to, iter(self._arcs[to])))
                        break
                    if component[to] < 0:
                        low[place] = min(low[place], number[to])
                else:
                    frames.pop()
                    if frames:
                        low[frames[-1][0]] = min(low[frames[-1][0]], low[place])
                    if low[place] == number[place]:
                        while component[place] < 0:
                            component[open_nodes.pop()] = place
        return component
