"""The nodes of a delay network: what a formula is made of once windows and nesting are apart."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.formula.core import Constant, Core, Literal


@dataclass(frozen=True, slots=True)
class Leaf:
    """What is read of a letter."""

    core: Literal | Constant


@dataclass(frozen=True, slots=True)
class Junction:
    """All of its operands, or one of them."""

    operands: tuple[int, ...]
    every: bool


@dataclass(frozen=True, slots=True)
class Window:
    """The operand at every position, or some, of a window.

    Attributes:
        operand: its place.
        low: integers from the position at hand to the first of the window; negative in the past.
        high: the same to the last.
        every: at every position, or at some.
        over: ticks after which no further position comes to lie in it; `None` in the past.
    """

    operand: int
    low: int
    high: int
    every: bool
    over: int | None


@dataclass(frozen=True, slots=True)
class Sweep:
    """`until` without bounds, or `since`, or the dual of one.

    Attributes:
        left: place of the operand that has to hold on the way.
        right: place of the operand to be met.
        future: whether it is `until`.
        dual: whether it is the dual, with negated operands and result.
        kept: whether the end of the trace counts as true for it (an unbounded `R`).
    """

    left: int
    right: int
    future: bool
    dual: bool
    kept: bool


@dataclass(frozen=True, slots=True)
class Shift:
    """The operand so many integers further on.

    Attributes:
        operand: its place; that of a `Sweep`.
        offset: integers; negative in the past.
        opens: ticks after which it speaks of something, at the end of a trace.
    """

    operand: int
    offset: int
    opens: int


Node = Leaf | Junction | Window | Sweep | Shift


@dataclass(frozen=True, slots=True)
class NetworkPlan:
    """A network before it has seen anything.

    Attributes:
        nodes: operands before operators, the root last.
        places: the place of each formula.
        leaves: the places of those that read a letter, with what they read.
        inner: those of the others, each with its place, in the same order.
        looks_back: whether something speaks of what was before an attempt began.
    """

    nodes: tuple[Node, ...]
    places: dict[Core, int]
    leaves: tuple[tuple[int, Literal | Constant], ...]
    inner: tuple[tuple[int, Junction | Window | Sweep | Shift], ...]
    looks_back: bool

    def sweep_of(self, node: Shift) -> Sweep:
        """What a node of the plan moves along."""
        found = self.nodes[node.operand]
        if not isinstance(found, Sweep):
            raise AssertionError("only an `until` or `since` is moved along")
        return found


def operands_of(node: Node) -> tuple[int, ...]:
    """The places of a node's operands."""
    if isinstance(node, Junction):
        return node.operands
    if isinstance(node, Window | Shift):
        return (node.operand,)
    return (node.left, node.right) if isinstance(node, Sweep) else ()
