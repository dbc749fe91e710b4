"""From a formula to the nodes of its network.

`φ U[a,b] ψ` is `F[a,b] ψ` and `G[0,a) φ` and, a further on, `φ U ψ`; so are its dual and its mirror
image. This holds of Kleene's values too, so that each part can be judged alone.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from rvmon.dataflow.nodes import Junction, Leaf, NetworkPlan, Node, Shift, Sweep, Window
from rvmon.formula.core import (
    And,
    Constant,
    Core,
    Literal,
    Next,
    Or,
    Previous,
    Release,
    Since,
    Until,
)


def plan_of(owed: Core, gap: int | None) -> NetworkPlan:
    """The network of what an attempt owes.

    Args:
        owed: the formula.
        gap: ticks between two positions; `None` if only samples are positions.
    """
    return plan_of_all([owed], gap)


def plan_of_all(formulas: Iterable[Core], gap: int | None) -> NetworkPlan:
    """One network of several formulas; `NetworkPlan.places` says where each stands.

    Args:
        formulas: of which somebody asks where they are true.
        gap: as for `plan_of`.
    """
    planning = _Planning(gap or 1)
    for formula in formulas:
        planning.place(formula)
    nodes = tuple(planning.nodes)
    leaves = tuple((place, node.core) for place, node in enumerate(nodes) if isinstance(node, Leaf))
    inner = tuple((place, node) for place, node in enumerate(nodes) if not isinstance(node, Leaf))
    looks_back = any(isinstance(core, Since | Previous) for core in planning.places)
    return NetworkPlan(nodes, planning.places, leaves, inner, looks_back)


class _Planning:
    def __init__(self, gap: int) -> None:
        self.gap = gap
        self.nodes: list[Node] = []
        self.places: dict[Core, int] = {}
        self._known: dict[Node, int] = {}

    def add(self, node: Node) -> int:
        """The place of a node; equal ones are one."""
        place = self._known.get(node)
        if place is None:
            place = self._known[node] = len(self.nodes)
            self.nodes.append(node)
        return place

    def place(self, core: Core) -> int:
        """The place of a formula."""
        place = self.places.get(core)
        if place is None:
            place = self.places[core] = self._place(core)
        return place

    def _place(self, core: Core) -> int:
        match core:
            case Constant() | Literal():
                return self.add(Leaf(core))
            case And(args=args) | Or(args=args):
                return self.join([self.place(arg) for arg in args], isinstance(core, And))
            case Next(operand=operand):
                return self._neighbour(operand, 1, False)
            case Previous(operand=operand, first=first):
                return self._neighbour(operand, -1, first)
            case Until() | Release():
                return self._ahead(core)
            case Since():
                return self._behind(core)
            case _:
                assert_never(core)

    def join(self, parts: list[int], every: bool) -> int:
        """All of some places, or one of them."""
        different = tuple(dict.fromkeys(parts))
        return different[0] if len(different) == 1 else self.add(Junction(different, every))

    def _neighbour(self, operand: Core, offset: int, first: bool) -> int:
        """The operand at the next position, or at the one before; `first` where there is none.

        Among integers it is that of the nearest position, which an `until` finds whose left operand
        holds at no position.
        """
        own = self.place(operand)
        nowhere = self.add(Leaf(_NOWHERE[first]))
        nearest = self.add(Sweep(nowhere, own, offset > 0, first, False))
        return self.add(Shift(nearest, offset, 0))

    def _ahead(self, core: Until | Release) -> int:
        every = isinstance(core, Release)
        low = -(-core.low // self.gap)
        kept = every and core.high is None

        def window(operand: int, first: int, last: int, every: bool, over: int) -> int:
            return self.add(Window(operand, first, last, every, over))

        parts = []
        if core.high is not None:
            high = core.high // self.gap
            parts.append(window(self.place(core.right), low, high, every, core.high + 1))
        if core.high is None or not _is_neutral(core.left, every):
            swept = self.add(
                Sweep(self.place(core.left), self.place(core.right), True, every, kept)
            )
            parts.append(self.add(Shift(swept, low, core.low)) if core.low else swept)
        if core.low and not _is_neutral(core.left, every):
            parts.append(window(self.place(core.left), 0, low - 1, not every, core.low))
        return self.join(parts, not every)

    def _behind(self, core: Since) -> int:
        every = core.dual
        low = -(-core.low // self.gap)

        def window(operand: int, first: int, last: int, every: bool) -> int:
            return self.add(Window(operand, -last, -first, every, None))

        parts = []
        if core.high is not None:
            parts.append(window(self.place(core.right), low, core.high // self.gap, every))
        if core.high is None or not _is_neutral(core.left, every):
            left, right = self.place(core.left), self.place(core.right)
            swept = self.add(Sweep(left, right, False, every, False))
            parts.append(self.add(Shift(swept, -low, 0)) if core.low else swept)
        if core.low and not _is_neutral(core.left, every):
            parts.append(window(self.place(core.left), 0, low - 1, not every))
        return self.join(parts, not every)


def _is_neutral(left: Core, every: bool) -> bool:
    """Whether the left operand of an operator asks for nothing."""
    return isinstance(left, Constant) and left.value is not every


_NOWHERE: dict[bool, Constant] = {False: Constant(-1, False), True: Constant(-2, True)}
