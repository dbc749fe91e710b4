"""What is reported of state formulas at a position, by whatever works out their values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from rvmon.plan.graph import Graph
from rvmon.plan.outages import Outage


class Standing(Protocol):
    """The truth of state formulas at a position, and since when, from whoever evaluates them."""

    @property
    def graph(self) -> Graph:
        """The formulas."""

    @property
    def gap(self) -> int | None:
        """Ticks between two positions; `None` if only samples are positions."""

    @property
    def values(self) -> Any:
        """By place, the truth."""

    @property
    def since(self) -> Any:
        """By place, the position from which on it has been that."""

    @property
    def position(self) -> int:
        """That the values are of."""

    @property
    def begun(self) -> int | None:
        """The position from which on it saw what is its own; `None`: it saw all."""

    @property
    def is_cut(self) -> bool:
        """Whether it is not known any more which values were captured."""

    @property
    def outages(self) -> Mapping[str, Outage]:
        """By name what is not known now, and since when."""

    def last_with(self, place: int, value: int, t: int) -> int | None:
        """The last position up to `t`, not before the present one, with a value."""
