"""What a search needs and what it gives: problems, nodes, budgets, results."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from rvmon.timed.zones.dbm import CoverTest, Zone
from rvmon.timed.zones.zone_unions import Constraint


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
    """Where a search starts, how it goes on, what it seeks.

    Attributes:
        dim: of all zones.
    """

    @property
    def dim(self) -> int:
        """One more than the number of clocks."""
        ...

    def start(self) -> Iterable[tuple[SiteT, Zone]]:
        """The symbolic states to start from."""
        ...

    def successors(self, site: SiteT, zone: Zone) -> Iterable[tuple[LinkT_co, SiteT, Zone]]:
        """The next symbolic states, normalised, none of them empty."""
        ...

    def goal(self, site: SiteT, zone: Zone) -> Constraint | None:
        """A part of the zone that is sought; `None` if the symbolic state has none."""
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


@dataclass(frozen=True, slots=True)
class Budget:
    """When a search gives up; `None` is no limit.

    Attributes:
        states: symbolic states visited.
        seconds: of wall-clock time.
        megabytes: of memory that the whole process holds.
    """

    states: int | None = None
    seconds: float | None = None
    megabytes: int | None = None


UNLIMITED = Budget()


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a search is: symbolic states visited and waiting, seconds since it began."""

    visited: int
    waiting: int
    seconds: float


Watch = Callable[[Progress], None]


@dataclass(frozen=True, slots=True)
class Statistics:
    """What a search cost.

    Attributes:
        visited: symbolic states that were kept when they were met.
        stored: those that were not dropped later for a larger one.
        seconds: of wall-clock time.
    """

    visited: int
    stored: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Found(Generic[SiteT, LinkT]):
    """The end of a search: what was sought and the part of its zone, or `None` twice."""

    node: Node[SiteT, LinkT] | None
    constraint: Constraint | None
