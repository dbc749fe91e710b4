"""Attempts that stay open for ever, on runs on which time passes without end.

Where all that is required without deadline is that something happens, such a run fails it
though none of its beginnings does. The product of network and monitor is gone through with zones
that are blurred up to bisimulation, and one more clock, which a move sets to 0 where it finds that
a unit of time has passed: time passes without end on a loop if such a move is on it.

Source: Tripakis, Yovine, Bouajjani, Checking Timed Büchi Automata Emptiness Efficiently, 2005.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from itertools import pairwise

from rvmon.logic.formula import Core, Next, Release, Until, nodes_of
from rvmon.timed.observation.observer import Observed, ObservedLink, ObservedSite, Phase
from rvmon.timed.search.explore import Node
from rvmon.timed.search.meter import Meter
from rvmon.timed.zones.dbm import STRICT, Zone, blurred, constrain, normalise, reset

_Node = Node[ObservedSite, ObservedLink]
_Arc = tuple[int, ObservedLink, bool]


def open_means(required: Core) -> bool | None:
    """Whether an attempt that stays open for ever is met; `None` if that depends on more.

    Without deadline may be promises (`eventually`), or prohibitions (`always`), but not both.
    """
    nodes = list(nodes_of(required))
    unbounded = {
        isinstance(node, Release)
        for node in nodes
        if isinstance(node, Until | Release) and node.high is None
    }
    if len(unbounded) > 1 or any(isinstance(node, Next) for node in nodes):
        return None
    return unbounded.pop() if unbounded else True


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
        return self._loop()

    def _loop(self) -> tuple[_Node, int] | None:
        """A loop on which time passes: one with a move that notes it, in one component."""
        import networkx as nx

        graph = nx.DiGraph()
        for place, arcs in enumerate(self._arcs):
            graph.add_edges_from((place, to, {"link": link}) for to, link, _ in arcs)
        for members in nx.strongly_connected_components(graph):
            for place in sorted(members):
                for to, link, tick in self._arcs[place]:
                    if tick and to in members:
                        way = nx.shortest_path(graph, to, place)
                        links = [link, *(graph.edges[pair]["link"] for pair in pairwise(way))]
                        return self._round(place, way, links)
        return None

    def _round(self, place: int, way: list[int], links: list[ObservedLink]) -> tuple[_Node, int]:
        """The run to a node and on by some links to others, the last of which is the node again."""
        node = self._nodes[place]
        loop = len(node.path()) - 1
        for to, link in zip(way, links, strict=True):
            node = Node(self._nodes[to].site, self._nodes[to].zone, node, link)
        return node, loop

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
