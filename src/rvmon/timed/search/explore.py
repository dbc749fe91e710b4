"""Search through symbolic states, with those dropped that another one makes needless."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

from rvmon.timed.search.meter import Meter, paused_collector
from rvmon.timed.search.problem import Found, LinkT, Node, Problem, SiteT
from rvmon.timed.zones.dbm import CoverTest, cover_test, passes
from rvmon.timed.zones.zone_unions import Constraint


def explore(
    problem: Problem[SiteT, LinkT],
    meter: Meter,
    visit: Callable[[Node[SiteT, LinkT]], None] | None = None,
) -> Found[SiteT, LinkT]:
    """Search breadth first, so that what is found is reached in the fewest steps.

    Args:
        problem: what to search for.
        meter: counts the states that are kept.
        visit: called with each node that is met, also if it is not kept.

    Source: Behrmann, Bengtsson, David, Larsen, Pettersson, Yi, UPPAAL Implementation Secrets, 2002
    (one list of passed and waiting states).
    """
    passed: dict[SiteT, list[Node[SiteT, LinkT]]] = {}
    waiting: deque[Node[SiteT, LinkT]] = deque()
    dim = problem.dim
    found: tuple[Node[SiteT, LinkT], Constraint] | None = None

    def meet(node: Node[SiteT, LinkT]) -> bool:
        """Keep a new node unless it is covered; False ends the search."""
        nonlocal found
        site, zone = node.site, node.zone
        if visit is not None:
            visit(node)
        nodes = passed.get(site)
        if nodes is None:
            passed[site] = [node]
        else:
            test = _test_of(node, dim)
            place = _first_passing(nodes, test)
            if place is not None:
                node.covered = True
                # What covered one will cover the next.
                nodes[place], nodes[0] = nodes[0], nodes[place]
                return True
            for old in nodes:
                old.covered = passes(zone, old.test or _test_of(old, dim))
            nodes[:] = [old for old in nodes if not old.covered]
            nodes.append(node)
        constraint = problem.goal(site, zone)
        if constraint is not None:
            found = node, constraint
        waiting.append(node)
        return meter.count(len(waiting)) and found is None

    with paused_collector():
        going = all(meet(Node(site, zone, None, None)) for site, zone in problem.start())
        while going and waiting:
            node = waiting.popleft()
            if node.covered:
                continue
            for link, site, zone in problem.successors(node.site, node.zone):
                if not meet(Node(site, zone, node, link)):
                    going = False
                    break
    meter.stored += sum(map(len, passed.values()))
    last, constraint = found or (None, None)
    return Found(last, constraint)


def _test_of(node: Node[SiteT, LinkT], dim: int) -> CoverTest:
    if node.test is None:
        node.test = cover_test(node.zone, dim, node.site.uppers, node.site.lowers)
    return node.test


def _first_passing(nodes: Sequence[Node[SiteT, LinkT]], test: CoverTest) -> int | None:
    """The place of the first node whose zone passes a test: most of a search's time is here."""
    for place, node in enumerate(nodes):
        zone = node.zone
        for entry, least in test:
            if zone[entry] < least:
                break
        else:
            return place
    return None
