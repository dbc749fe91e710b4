"""Chains: windows nested in windows over a propositional base, decided in the order of positions.

No position of such a formula is decided before an earlier one: `F` is decided by the first position
of its window that holds, `G` by the last. So the decided positions form a prefix, and the state is
its length with the positions at which the value changes. The same holds for an invariant over a
chain (`whenever`, `always`): the first position at which it fails is the first one decided.
"""

from __future__ import annotations

from collections.abc import Sequence

from msgspec import Struct

from rvmon.logic.formula import Constant, Sense
from rvmon.logic.network_plan import Junction, Leaf, NetworkPlan, Node, Shift, Sweep, Window


class Chain(Struct, frozen=True):
    """The chain of a network plan; places are indices of its nodes."""

    base: int  # place of the operand of the innermost window: a leaf, or a junction of leaves
    windows: tuple[Window, ...]  # innermost first
    # place of the leaf that releases the invariant; `None` if this is no invariant
    left: int | None
    places: tuple[int, ...]  # places of the windows
    # place of a leaf that is a disjunct of the invariant's body, `None` if there is none. It is
    # true wherever `left` is, unless something is unknown
    excused: int | None


def reach_of(plan: NetworkPlan) -> int | None:
    """The ticks after which a position is decided, or depends on later positions alone.

    `None` if that is unbounded, or if a node looks back.
    """

    def reach(node: Node) -> int | None:
        match node:
            case Leaf():
                return 0
            case Junction(operands=operands):
                return known([within(node, place) for place in operands])
            case Window(operand=operand, over=int(over)):
                return after(over, operand)
            case Window() | Shift() | Sweep():
                return None

    def within(junction: Junction, place: int) -> int | None:
        """The reach of an operand; an unbounded `until` may be bounded by its sibling window.

        `φ U[a,b] ψ` is planned as a junction of `F[a,b] ψ` with an unbounded `until`: if ψ is not
        met in the window, the window decides the junction, and if it is, the `until` is decided.
        """
        node = plan.nodes[place]
        low = node.offset if isinstance(node, Shift) else 0
        swept = plan.sweep_of(node) if isinstance(node, Shift) else node
        if isinstance(swept, Sweep) and swept.future and swept.dual is not junction.every:
            for bound in map(plan.nodes.__getitem__, junction.operands):
                match bound:
                    case Window(over=int(over)) if (
                        bound.operand == swept.right
                        and bound.every is swept.dual
                        and bound.low == low
                    ):
                        return after(over, swept.left, swept.right)
        return reach(node)

    def after(over: int, *places: int) -> int | None:
        inner = greatest(*places)
        return None if inner is None else inner + over

    def greatest(*places: int) -> int | None:
        return known([reach(plan.nodes[place]) for place in places])

    def known(found: Sequence[int | None]) -> int | None:
        bounds = [one for one in found if one is not None]
        return max(bounds) if len(bounds) == len(found) else None

    root = plan.nodes[-1]
    if isinstance(root, Sweep) and root.future:
        return greatest(root.left, root.right)
    return reach(root)


def chain_of(plan: NetworkPlan, gap: int | None) -> Chain | None:
    """The plan as a chain; `None` if it is not one.

    Where only samples are positions, a window with a positive lower bound may contain no position.
    Then the decided positions need not be a prefix, so such a plan is not a chain.
    """
    nodes = plan.nodes
    top, left, excused = len(nodes) - 1, None, None
    root = nodes[top]
    if isinstance(root, Sweep):
        end = nodes[root.left]
        if not (root.future and root.dual and isinstance(end, Leaf)):
            return None
        left, top = root.left, root.right
        right = nodes[top]
        if isinstance(right, Junction):
            inner = [operand for operand in right.operands if not _ends(plan, left, operand)]
            if right.every or len(inner) != 1 or len(right.operands) != 2:
                return None
            top = inner[0]
            excused = next(operand for operand in right.operands if operand != top)
        elif not isinstance(end.core, Constant):
            return None  # `p R φ` requires φ also at the position where p ends it
    windows: list[Window] = []
    places: list[int] = []
    node = nodes[top]
    while isinstance(node, Window) and node.over is not None and node.low <= node.high:
        if gap is None and node.low:
            return None
        windows.append(node)
        places.append(top)
        top = node.operand
        node = nodes[top]
    if not windows or not _is_read(plan, top):
        return None
    return Chain(top, tuple(reversed(windows)), left, tuple(reversed(places)), excused)


def _ends(plan: NetworkPlan, left: int, place: int) -> bool:
    """Whether both leaves deny the same proposition, so that they agree where it is known."""
    one, other = plan.nodes[left], plan.nodes[place]
    if not (isinstance(one, Leaf) and isinstance(other, Leaf)):
        return False
    if isinstance(one.core, Constant) or isinstance(other.core, Constant):
        return False
    falses = (Sense.FALSE, Sense.KNOWN_FALSE)
    return (
        one.core.proposition is other.core.proposition
        and one.core.sense in falses
        and other.core.sense in falses
    )


def _is_read(plan: NetworkPlan, place: int) -> bool:
    """Whether a node is propositional: decided by the letter at its position."""
    node = plan.nodes[place]
    if isinstance(node, Junction):
        return all(_is_read(plan, operand) for operand in node.operands)
    return isinstance(node, Leaf)
