"""The truth of state formulas as it stood at a position, kept for later."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from rvmon.plan.graph import Graph
from rvmon.plan.outages import Outage


class Formulas(Protocol):
    """State formulas, and at which positions they have values; see `Plan`."""

    @property
    def graph(self) -> Graph:
        """The formulas."""

    @property
    def gap(self) -> int | None:
        """Ticks between two positions; `None` if only samples are positions."""


class Stood:
    """The values of state formulas as they stood; see `rvmon.plan.standing.Standing`.

    Args:
        of: a plan, or what works out the values; has the nodes.
        values: by node, its truth.
        since: by node of a letter, the position from which on it has had that.
        until: by three times the node plus a truth, the last position at which it had that before.
        outages: by name what was not known.
        position: that the values are of.
        begun: see `Standing`.
    """

    is_cut = False

    def __init__(
        self,
        of: Formulas,
        values: Any,
        since: Any,
        until: Any,
        outages: Mapping[str, Outage],
        position: int,
        begun: int | None = None,
    ) -> None:
        self.graph = of.graph
        self.gap = of.gap
        self.begun = begun
        self.values = values
        self.since = since
        self.outages = outages
        self.position = position
        self._until = until

    def last_with(self, place: int, value: int, t: int) -> int | None:
        """See `Standing`; of the propositions that the requirement owes."""
        found: int | None = t if self.values[place] == value else self._until[3 * place + value]
        return found
