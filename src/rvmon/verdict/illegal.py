"""What a run hit of a coverage model and must not."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.trace.time import format_ticks


@dataclass(frozen=True, slots=True)
class IllegalHit:
    """A bin of a coverpoint, or a combination of a cross, that must not be hit and was.

    Attributes:
        group: the coverpoint or cross.
        item: the bin or combination.
        count: how often it was hit.
        first: the instant of the first hit, ticks.
    """

    group: str
    item: str
    count: int
    first: int

    def __str__(self) -> str:
        """One sentence for people.

        >>> print(IllegalHit("phase", "back", 2, 3 * 10**9))
        illegal: `back` of `phase` was hit at 3 s, 2 times in all
        """
        often = f", {self.count} times in all" if self.count > 1 else ""
        return (
            f"illegal: `{self.item}` of `{self.group}` was hit at {format_ticks(self.first)}{often}"
        )
