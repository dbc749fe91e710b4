"""What is assumed of the part of a trace that nobody has seen."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from rvmon.dataflow.margins import INFINITE


class Rest(Enum):
    """What is assumed of the part of an operator that lies behind the end of the trace."""

    LEAST = "least"
    GREATEST = "greatest"
    END = "end"
    """The rule for the end: the greatest for an unbounded `R` that has begun, else the least."""


@dataclass(frozen=True, slots=True)
class End:
    """The end of a trace.

    Attributes:
        instant: the last one, ticks.
        last: the last integer that may be a position.
        rest: what is assumed of what lies behind.
    """

    instant: int
    last: int
    rest: Rest

    @property
    def pending(self) -> float:
        """The value of what lies behind, where it does not count as kept up."""
        return INFINITE if self.rest is Rest.GREATEST else -INFINITE

    def behind(self, kept: bool) -> float:
        """The value of an `until` behind the end.

        Args:
            kept: whether the end counts as true for it.
        """
        return INFINITE if self.rest is Rest.END and kept else self.pending
