"""Search through symbolic states, with those dropped that another one makes needless."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Sequence
from typing import Generic, Protocol, TypeVar

from rvmon.timed.search.meter import Meter, paused_collector
from rvmon.timed.zones.dbm import CoverTest, Zone, cover_test, passes


class Site(Protocol):
    """The discrete part of a symbolic state: one object for each.

    Attributes:
        uppers, lowers: the clock bounds that matter there, as `zones.cover_test` takes them.
    """

    @property
    def uppers(self) -> Sequence[tuple[int, float]]:
        """`(clock, −U)` for each clock with an upper bound."""
        ...

    @property
    def lowers(self) -> Sequence[tuple[int, float]]:
        """`(clock, L)` for each clock with a lower bound."""
        ...


SiteT = TypeVar("SiteT", bound=Site)
LinkT = TypeVar("LinkT")
LinkT_co = TypeVar("LinkT_co", covariant=True)


class Problem(Protocol[SiteT, LinkT_co]):
    """Where a search starts and how it goes on.

    Attributes:
        dim: of all zones: one more than the number of clocks.
    """

    dim: int

    def start(self) -> Iterable[tuple[SiteT, Zone]]:
        """The symbolic states to start from."""
        ...

    def successors(self, site: SiteT, zone: Zone) -> Iterable[tuple[LinkT_co, SiteT, Zone]]:
        """The next symbolic states, normalised, none of them empty."""
        ...


class Node(Generic[SiteT, LinkT]):
    """A symbolic state that a search has met, and how it came there.

    Attributes:
        parent, link: the node before and the step from it; `None` at the start.
        covered: whether another node makes this one needless.
        test: what zones must pass that do so; `None` until it was asked for.
    """

    __slots__ = ("covered", "link", "parent", "site", "test", "zone")

    def __init__(
        self, site: SiteT, zone: Zone, parent: Node[SiteT, LinkT] | None, link: LinkT | None
    ) -> None:
        self.site = site
        self.zone = zone
        self.parent = parent
        self.link = link
        self.covered = False
        self.test: CoverTest | None = None

    def path(self) -> list[Node[SiteT, LinkT]]:
        """The nodes from the start to this one."""
        nodes: list[Node[SiteT, LinkT]] = []
        node: Node[SiteT, LinkT] | None = self
        while node is not None:
            nodes.append(node)
            node = node.parent
        return nodes[::-1]


def explore(
    problem: Problem[SiteT, LinkT],
    meter: Meter,
    visit: Callable[[Node[SiteT, LinkT]], None],
) -> None:
    """Search breadth first, so that what is met is reached in the fewest steps.

    Args:
        problem: what to go through.
        meter: counts the states that are kept.
        visit: called with each node that is met, also if it is not kept.

    Source: Behrmann, Bengtsson, David, Larsen, Pettersson, Yi, UPPAAL Implementation Secrets, 2002
    (one list of passed and waiting states).
    """
    passed: dict[SiteT, list[Node[SiteT, LinkT]]] = {}
    waiting: deque[Node[SiteT, LinkT]] = deque()
    dim = problem.dim

    def meet(node: Node[SiteT, LinkT]) -> bool:
        """Keep a new node unless it is covered; False ends the search."""
        site, zone = node.site, node.zone
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
        waiting.append(node)
        return meter.count(len(waiting))

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
