"""The coverage of one run: the hits of coverpoints and crosses, and illegal hits, as data."""

from __future__ import annotations

from msgspec import Struct

from rvmon.language.checked.properties import BinKind
from rvmon.trace.time import format_stamped


class CoveredBin(Struct, frozen=True):
    """A bin of a coverpoint, or a combination of a cross, on one run."""

    name: str  # of the bin or combination
    kind: BinKind  # goal, ignored or illegal
    goal: int  # the hits it needs
    hits: int  # the number of hits
    first: int | None = None  # the instant of the first hit, ticks; `None` without one

    @property
    def is_hole(self) -> bool:
        """Whether it has fewer hits than its goal."""
        return self.kind is BinKind.GOAL and self.hits < self.goal


class CoveredGroup(Struct, frozen=True):
    """A `coverpoint` or `cross` on one run, with its bins or combinations in the file's order."""

    name: str
    subject: str
    bins: tuple[CoveredBin, ...]


class IllegalHit(Struct, frozen=True):
    """An illegal bin of a coverpoint, or an illegal combination of a cross, that was hit."""

    group: str  # the coverpoint or cross
    item: str  # the bin or combination
    count: int  # the number of hits
    first: int  # the instant of the first hit, ticks

    def sentence(self, origin: int) -> str:
        """One sentence; `origin` is the instant shown as 0 s, ticks.

        >>> print(IllegalHit("phase", "back", 2, 3 * 10**9).sentence(0))
        illegal: `back` of `phase` was hit at 3 s, 2 times in all
        """
        often = f", {self.count} times in all" if self.count > 1 else ""
        when = format_stamped(self.first, origin)
        return f"illegal: `{self.item}` of `{self.group}` was hit at {when}{often}"
