"""The delay networks of a plan as C tables, for what no automaton judges."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

from rvmon.codegen.c_tables import array
from rvmon.dataflow.network_plan import plan_of
from rvmon.dataflow.nodes import Junction, Leaf, NetworkPlan, Node, Shift, Sweep, Window
from rvmon.formula.core import Constant, Sense
from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.plan.plan import Plan

_FARTHEST = (1 << 62) - 2
"""No two instants of a trace that need to be told apart are farther from each other."""

_PAST = -1
"""In the place of what tells when a window is over."""

_WORSE, _BETTER = 1, 2


class Networks:
    """The networks of a plan, one for each judge without an automaton.

    Args:
        plan: what is generated.

    Attributes:
        number: by number of the judge, that of its network.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        judged = [index for index, (_, rule) in enumerate(plan.judges) if rule.automaton is None]
        self.number = {index: number for number, index in enumerate(judged)}

    @cached_property
    def plans(self) -> Sequence[NetworkPlan]:
        """Their nodes."""
        judges = self._plan.judges
        return [plan_of(judges[index][1].owed, self._plan.gap) for index in self.number]

    @property
    def sizes(self) -> dict[str, int]:
        """How many networks there are, nodes of all of them, and leaves."""
        return {
            "NETWORKS": len(self.plans),
            "OPERATORS": sum(len(plan.nodes) for plan in self.plans),
            "LEAVES": sum(len(plan.leaves) for plan in self.plans),
        }

    def tables(self) -> Iterator[str]:
        """What the templates read."""
        nodes: list[str] = []
        forms: list[str] = []
        self._operands: list[int] = []
        self._values: list[int] = []
        for plan in self.plans:
            looks_back = str(plan.looks_back).lower()
            forms.append(f"    {{{len(nodes)}, {len(plan.nodes)}, {looks_back}}},")
            nodes += [f"    {{{self._node(plan, node)}}}," for node in plan.nodes]
        yield "static const node nodes[] = {"
        yield from nodes
        yield "};"
        yield "static const form forms[] = {"
        yield from forms
        yield "};"
        yield array("int32_t", "operands", self._operands)
        yield "/* Per leaf, by the truth of what it reads: 1 if it is true for the worse, and 2 for"
        yield " * the better. */"
        yield array("uint8_t", "leaf_values", self._values)

    def _node(self, plan: NetworkPlan, node: Node) -> str:
        """The fields of a node."""
        match node:
            case Leaf():
                return self._leaf(node)
            case Junction(operands=operands, every=every):
                start = len(self._operands)
                self._operands += operands
                return _fields("JUNCTION", every, False, start, start + len(operands))
            case Window(operand=operand, low=low, high=high, every=every, over=over):
                past = _PAST if over is None else over
                return _fields("WINDOW", every, False, operand, 0, low, high, past)
            case Sweep(left=left, right=right, future=future, dual=dual, kept=kept):
                return _fields("UNTIL" if future else "SINCE", dual, kept, left, right)
            case Shift(operand=operand, offset=offset, opens=opens):
                swept = plan.nodes[operand]
                kept = isinstance(swept, Sweep) and swept.kept
                return _fields("SHIFT", False, kept, operand, 0, offset, offset, opens)

    def _leaf(self, leaf: Leaf) -> str:
        number = len(self._values) // 3
        core = leaf.core
        if isinstance(core, Constant):
            self._values += [(_WORSE + _BETTER) * core.value] * 3
            return _fields("LEAF", False, False, number, -1)
        wanted = TRUE if core.sense is Sense.TRUE else FALSE
        unknown = 0 if core.sense is Sense.KNOWN_FALSE else _BETTER
        for value in (FALSE, UNKNOWN, TRUE):
            known = (_WORSE + _BETTER) * (value == wanted)
            self._values.append(unknown if value == UNKNOWN else known)
        return _fields("LEAF", False, False, number, self._plan.graph.index[core.proposition])


def _fields(kind: str, turned: bool, kept: bool, left: int, right: int, *distances: int) -> str:
    """Of a node, as its type in C has them."""
    low, high, over = (max(-_FARTHEST, min(one, _FARTHEST)) for one in distances or (0, 0, 0))
    ticks = ", ".join(f"INT64_C({one})" for one in (low, high, over))
    return f"{kind}, {int(turned)}, {str(kept).lower()}, {left}, {right}, {ticks}"
