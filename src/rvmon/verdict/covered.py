"""What one run hit of coverpoints and crosses, and what not, as data."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.spec.checked.goals import BinKind


@dataclass(frozen=True, slots=True)
class CoveredBin:
    """A bin of a coverpoint, or a combination of a cross, on one run.

    Attributes:
        name: of the bin or combination.
        kind: what a hit means.
        goal: hits that it needs.
        hits: how often it was hit.
        first: the instant of the first hit, ticks; `None` without one.
    """

    name: str
    kind: BinKind
    goal: int
    hits: int
    first: int | None = None

    @property
    def is_hole(self) -> bool:
        """Whether it was hit less often than its goal asks for."""
        return self.kind is BinKind.GOAL and self.hits < self.goal


@dataclass(frozen=True, slots=True)
class CoveredGroup:
    """A coverpoint or a cross on one run.

    Attributes:
        name: of the coverpoint or cross.
        subject: which of both it is.
        bins: all of it, in the order of the specification.
    """

    name: str
    subject: str
    bins: tuple[CoveredBin, ...]
