"""Splits a formula into the nodes of its network: leaves, junctions, windows, sweeps and shifts.

`φ U[a,b] ψ` is `F[a,b] ψ` and `G[0,a) φ` and, shifted by a, the unbounded `φ U ψ`; likewise its
dual and its mirror image in the past. The identity also holds in Kleene's three values, so that
each node can be evaluated on its own.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from msgspec import Struct

from rvmon.logic import formula as mtl


class Leaf(Struct, frozen=True):
    """A literal or constant, evaluated on the letter of a position."""

    core: mtl.Literal | mtl.Constant


class Junction(Struct, frozen=True):
    """A conjunction (`every`) or disjunction of nodes."""

    operands: tuple[int, ...]
    every: bool


class Window(Struct, frozen=True):
    """`G[a,b]` (`every`) or `F[a,b]` of a node, or `H` or `O` in the past.

    Offsets count units of `gap`: positions in clocked time, else ticks.
    """

    operand: int  # its place
    low: int  # offset from the current position to the start of the window; negative in the past
    high: int  # offset to the end of the window, inclusive
    every: bool  # whether the operand must hold at all positions of the window, or at some
    # ticks after which no new position can fall into the window; `None` in the past
    over: int | None


class Sweep(Struct, frozen=True):
    """An unbounded `until` or `since`, or the dual of one."""

    left: int  # place of the left operand
    right: int  # place of the right operand
    future: bool  # whether it is `until`, not `since`
    dual: bool  # whether operands and result are negated (`release`, or the dual of `since`)
    kept: bool  # whether it is true at the end of the trace if undecided (an unbounded `R`)


class Shift(Struct, frozen=True):
    """The value of a sweep at a fixed offset."""

    operand: int  # place of a `Sweep`
    offset: int  # in units of `gap`, as for `Window`; negative in the past
    opens: int  # ticks until the window opens; at the end of a trace only an opened one counts


Node = Leaf | Junction | Window | Sweep | Shift


class NetworkPlan(Struct, frozen=True):
    """The static structure of a network."""

    nodes: tuple[Node, ...]  # operands before operators, the root last
    places: dict[mtl.Core, int]  # the place of each formula
    # places of the leaves, with their literal or constant
    leaves: tuple[tuple[int, mtl.Literal | mtl.Constant], ...]
    looks_back: bool  # whether some node depends on positions before the start of the attempt

    def sweep_of(self, node: Shift) -> Sweep:
        """The sweep that a shift node reads."""
        found = self.nodes[node.operand]
        if not isinstance(found, Sweep):
            raise AssertionError("the operand of a shift is a sweep")
        return found


def operands_of(node: Node) -> tuple[int, ...]:
    """The places of a node's operands."""
    if isinstance(node, Junction):
        return node.operands
    if isinstance(node, Window | Shift):
        return (node.operand,)
    return (node.left, node.right) if isinstance(node, Sweep) else ()


def plan_of(required: mtl.Core, gap: int | None) -> NetworkPlan:
    """The network of one formula; `gap`: ticks between positions, `None` in sampled time."""
    return plan_of_all([required], gap)


def plan_of_all(formulas: Iterable[mtl.Core], gap: int | None) -> NetworkPlan:
    """One network of several formulas; `NetworkPlan.places` has the place of each."""
    planning = _Planning(gap or 1)
    for formula in formulas:
        planning.place(formula)
    nodes = tuple(planning.nodes)
    leaves = tuple((place, node.core) for place, node in enumerate(nodes) if isinstance(node, Leaf))
    looks_back = any(isinstance(core, mtl.Since | mtl.Previous) for core in planning.places)
    return NetworkPlan(nodes, planning.places, leaves, looks_back)


class _Planning:
    def __init__(self, gap: int) -> None:
        self.gap = gap
        self.nodes: list[Node] = []
        self.places: dict[mtl.Core, int] = {}
        self._known: dict[Node, int] = {}

    def add(self, node: Node) -> int:
        """The place of a node; equal nodes share one."""
        place = self._known.get(node)
        if place is None:
            place = self._known[node] = len(self.nodes)
            self.nodes.append(node)
        return place

    def place(self, core: mtl.Core) -> int:
        """The place of a formula."""
        place = self.places.get(core)
        if place is None:
            place = self.places[core] = self._place(core)
        return place

    def _place(self, core: mtl.Core) -> int:
        match core:
            case mtl.Constant() | mtl.Literal():
                return self.add(Leaf(core))
            case mtl.And(args=args) | mtl.Or(args=args):
                return self.join([self.place(arg) for arg in args], isinstance(core, mtl.And))
            case mtl.Next(operand=operand):
                return self._neighbour(operand, 1, False)
            case mtl.Previous(operand=operand, first=first):
                return self._neighbour(operand, -1, first)
            case mtl.Until() | mtl.Release() | mtl.Since():
                return self._windowed(core)
            case _:
                assert_never(core)

    def join(self, parts: list[int], every: bool) -> int:
        """The place of the conjunction, or disjunction, of some places."""
        different = tuple(dict.fromkeys(parts))
        return different[0] if len(different) == 1 else self.add(Junction(different, every))

    def _neighbour(self, operand: mtl.Core, offset: int, first: bool) -> int:
        """The operand at the next position, or the previous one; `first` where there is none.

        `false U φ`, shifted by one tick, reads φ at the nearest position: only positions count,
        wherever on the ticks they lie. Likewise `since` for the past, and the duals.
        """
        own = self.place(operand)
        nowhere = self.add(Leaf(_NOWHERE[first]))
        nearest = self.add(Sweep(nowhere, own, offset > 0, first, False))
        return self.add(Shift(nearest, offset, 0))

    def _windowed(self, core: mtl.Until | mtl.Release | mtl.Since) -> int:
        """The parts of the identity in the module's docstring; offsets of the past are negative."""
        future = not isinstance(core, mtl.Since)
        every = core.dual if isinstance(core, mtl.Since) else isinstance(core, mtl.Release)
        low = -(-core.low // self.gap)

        def window(operand: mtl.Core, first: int, last: int, every: bool, over: int) -> int:
            own = (first, last, every, over) if future else (-last, -first, every, None)
            return self.add(Window(self.place(operand), *own))

        # A neutral left operand makes two of the three parts true, so they are not planned.
        parts = []
        if core.high is not None:
            parts.append(window(core.right, low, core.high // self.gap, every, core.high + 1))
        if core.high is None or not _is_neutral(core.left, every):
            kept = future and every and core.high is None
            left, right = self.place(core.left), self.place(core.right)
            swept = self.add(Sweep(left, right, future, every, kept))
            shift = Shift(swept, low, core.low) if future else Shift(swept, -low, 0)
            parts.append(self.add(shift) if core.low else swept)
        if core.low and not _is_neutral(core.left, every):
            parts.append(window(core.left, 0, low - 1, not every, core.low))
        return self.join(parts, not every)


def _is_neutral(left: mtl.Core, every: bool) -> bool:
    """Whether the left operand is neutral, so that the operator is `F`, `G`, `O` or `H`."""
    return isinstance(left, mtl.Constant) and left.value is not every


_NOWHERE: dict[bool, mtl.Constant] = {False: mtl.Constant(-1, False), True: mtl.Constant(-2, True)}
