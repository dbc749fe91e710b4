"""What writers of the nodes of a gauge share."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rvmon.dataflow.nodes import Junction, Leaf, NetworkPlan, operands_of
from rvmon.formula.core import Constant


class GaugeWriter:
    """Writes statements of a class that derives from `rvmon.dataflow.robust.Gauge`.

    A leaf `p` is new if `m<p>` is true, and then has the value `x<p>` from `start` on; what is new
    of another node stands in the list `n<p>`, and `k<p>` is the integer up to which it is known.

    Args:
        plan: of the formula that is measured.
        gap: ticks between two positions; `None` if only samples are positions.

    Attributes:
        sparse: whether only samples are positions.
        fixed: by place, the leaves that never change where all that read them read others, too.
        alone: the nodes whose value matters only where that of the formula is asked for.
        state: of each attribute of the class, what it is at first.
    """

    def __init__(self, plan: NetworkPlan, gap: int | None) -> None:
        self.plan = plan
        self.gap = gap or 1
        self.sparse = gap is None
        self.fixed = _fixed(plan)
        self.alone = asked_alone(plan)
        self.state: dict[str, str] = {}

    def is_leaf(self, place: int) -> bool:
        """Whether a node reads a letter."""
        return isinstance(self.plan.nodes[place], Leaf)

    def known(self, place: int) -> str:
        """Up to where a node is known."""
        return "now" if self.is_leaf(place) else f"k{place}"

    def given(self, place: int, kept: str) -> Iterator[str]:
        """Append what is new of a node."""
        if self.is_leaf(place):
            yield f"if m{place}:"
            yield f"    {kept}.append((start, x{place}))"
        else:
            yield f"{kept} += n{place}"


def _fixed(plan: NetworkPlan) -> Mapping[int, str]:
    """The leaves that never change, where all that read them read others as well."""
    found = {
        place: "INF" if core.value else "-INF"
        for place, core in plan.leaves
        if isinstance(core, Constant)
    }
    for node in plan.nodes:
        operands = operands_of(node)
        if all(place in found for place in operands):
            for place in operands:
                found.pop(place, None)
    found.pop(len(plan.nodes) - 1, None)
    return found


def asked_alone(plan: NetworkPlan) -> set[int]:
    """The nodes whose value matters only at the positions that the formula is asked for at."""
    alone, elsewhere = {len(plan.nodes) - 1}, set[int]()
    for place in range(len(plan.nodes) - 1, -1, -1):
        node = plan.nodes[place]
        joins = isinstance(node, Junction) and place in alone - elsewhere
        (alone if joins else elsewhere).update(operands_of(node))
    return alone - elsewhere
