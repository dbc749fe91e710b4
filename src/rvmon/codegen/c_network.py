"""The delay networks of a plan as C tables, for what no automaton judges."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

from rvmon.codegen.c_tables import array
from rvmon.dataflow.network_plan import plan_of
from rvmon.dataflow.nodes import Junction, Leaf, NetworkPlan, Node, Shift, Sweep, Window
from rvmon.formula.core import Constant, Literal, Sense
from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.plan.plan import Plan

_FARTHEST = (1 << 62) - 2
"""No two instants of a trace that need to be told apart are farther from each other."""

_PAST = -1
"""In the place of the deadline of a window."""

_WORSE, _BETTER = 1, 2


class Forms:
    """Formulas as C tables of nodes.

    Args:
        plan: of the whole, which has the numbers of propositions.
        plans: of the formulas.
    """

    def __init__(self, plan: Plan, plans: Sequence[NetworkPlan]) -> None:
        self.plans = plans
        self._index = plan.graph.index

    def tables(self) -> Iterator[str]:
        """The nodes, the operands of junctions, and where each formula begins."""
        nodes: list[str] = []
        forms: list[str] = []
        self._operands: list[int] = []
        self._leaves = 0
        for plan in self.plans:
            leaf, first = self._leaves, len(nodes)
            nodes += [f"    {{{self._node(plan, node)}}}," for node in plan.nodes]
            sizes = first, len(plan.nodes), leaf, len(plan.leaves)
            looks_back = str(plan.looks_back).lower()
            forms.append(f"    {{{', '.join(map(str, sizes))}, {looks_back}}},")
        yield "static const node nodes[] = {"
        yield from nodes
        yield "};"
        yield "static const form forms[] = {"
        yield from forms
        yield "};"
        yield array("int32_t", "operands", self._operands)

    def _node(self, plan: NetworkPlan, node: Node) -> str:
        """The fields of a node."""
        match node:
            case Leaf(core=core):
                self._leaves += 1
                place = -1 if isinstance(core, Constant) else self._index[core.proposition]
                return self._fields("LEAF", False, False, self._leaves - 1, place)
            case Junction(operands=operands, every=every):
                start = len(self._operands)
                self._operands += operands
                ends = start, start + len(operands)
                return self._fields("JUNCTION", every, False, *ends)
            case Window(operand=operand, low=low, high=high, every=every, over=over):
                past = _PAST if over is None else over
                return self._fields("WINDOW", every, False, operand, 0, low, high, past)
            case Sweep(left=left, right=right, future=future, dual=dual, kept=kept):
                kind = "UNTIL" if future else "SINCE"
                return self._fields(kind, dual, kept, left, right)
            case Shift(operand=operand, offset=offset, opens=opens):
                kept = plan.sweep_of(node).kept
                return self._fields("SHIFT", False, kept, operand, 0, offset, offset, opens)

    def _fields(
        self,
        kind: str,
        turned: bool,
        kept: bool,
        left: int,
        right: int,
        *distances: int,
    ) -> str:
        """Of a node, as its type in C has them."""
        ticks = (max(-_FARTHEST, min(one, _FARTHEST)) for one in distances or (0, 0, 0))
        numbers = [int(turned), str(kept).lower(), left, right]
        return ", ".join([kind, *map(str, numbers), *(f"INT64_C({one})" for one in ticks)])


class Networks:
    """The networks of a plan, one for each judge without an automaton.

    Args:
        plan: what is generated.

    Attributes:
        number: by number of the judge, that of its network.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        own = [n for n, (_, rule) in enumerate(plan.judges) if rule.automaton is None]
        self.number = {index: number for number, index in enumerate(own)}

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
        yield from Forms(self._plan, self.plans).tables()
        yield "/* Per leaf, by the truth of what it reads: 1 if it is true for the worse, and 2 for"
        yield " * the better. */"
        leaves = [core for plan in self.plans for _, core in plan.leaves]
        yield array("uint8_t", "leaf_values", [one for leaf in leaves for one in _values(leaf)])


def _values(core: Literal | Constant) -> Iterator[int]:
    """What a leaf counts as where its proposition is FALSE, UNKNOWN and TRUE."""
    if isinstance(core, Constant):
        yield from [(_WORSE + _BETTER) * core.value] * 3
        return
    wanted = TRUE if core.sense is Sense.TRUE else FALSE
    unknown = 0 if core.sense is Sense.KNOWN_FALSE else _BETTER
    for value in (FALSE, UNKNOWN, TRUE):
        known = (_WORSE + _BETTER) * (value == wanted)
        yield unknown if value == UNKNOWN else known
