"""What measures robustness, as C: the formulas of a plan as tables, and by how much leaves hold."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

from rvmon.codegen.c_leaves import TRUTHS, number_value, real
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_network import Forms
from rvmon.codegen.c_tables import array
from rvmon.codegen.c_text import filled, template
from rvmon.codegen.python_gauge import asked_alone
from rvmon.dataflow.margins import base_factor
from rvmon.dataflow.network_plan import plan_of
from rvmon.dataflow.nodes import NetworkPlan
from rvmon.formula.core import Constant, Literal, Sense
from rvmon.formula.expand import expanded
from rvmon.formula.state import FALSE, TRUE
from rvmon.plan.plan import Plan
from rvmon.spec.checked.formula import Compare, CompareOp, Numeric, SignalValue
from rvmon.spec.checked.formula import Literal as Number
from rvmon.trace.schema import Kind

_PARTS = ("queues", "windows", "joins", "gauge", "figures", "judge")

_SIGNED = {
    CompareOp.LT: "-{}",
    CompareOp.LE: "-{}",
    CompareOp.GT: "{}",
    CompareOp.GE: "{}",
    CompareOp.EQ: "-fabs({})",
    CompareOp.NE: "fabs({})",
}
"""As `rvmon.dataflow.margins.signed`."""


class Measures:
    """What is measured of the requirements of a plan.

    Args:
        plan: whose rules have what is measured among `asked`.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._names = Names(plan)

    @cached_property
    def plans(self) -> Sequence[NetworkPlan]:
        """The nodes of what is owed, by number of the judge."""
        owed = [rule.measured for _, rule in self._plan.judges]
        return [plan_of(expanded(one), self._plan.gap) for one in owed if one is not None]

    def source(self) -> str:
        """The templates, filled; they stand behind the monitor."""
        has_network = any(rule.automaton is None for _, rule in self._plan.judges)
        places = {
            "FORMULAS": "" if has_network else template("formulas.c.in"),
            "MEASURED_TABLES": "\n".join(self._tables()),
            "MARGINS": "\n".join(self._margins()),
        }
        return filled("".join(template(f"margin_{part}.c.in") for part in _PARTS), places)

    def _tables(self) -> Iterator[str]:
        leaves = [core for plan in self.plans for _, core in plan.leaves]
        yield from Forms(self._plan, self.plans).tables("measured_")
        yield "/* Per node, whether its value matters only where that of the formula is wanted. */"
        alone = [
            int(place in asked_alone(plan))
            for plan in self.plans
            for place in range(len(plan.nodes))
        ]
        yield array("uint8_t", "asked_alone", alone)
        yield "/* Per leaf its proposition, and its truth behind a position of which it speaks. */"
        index = self._plan.graph.index
        places = [-1 if isinstance(one, Constant) else index[one.proposition] for one in leaves]
        behind = [isinstance(one, Literal) and one.sense is not Sense.TRUE for one in leaves]
        yield array("int32_t", "leaf_places", places)
        yield array("uint8_t", "leaf_after", [TRUE if one else FALSE for one in behind])

    def _margins(self) -> Iterator[str]:
        """A function that reads the leaves of a judge; see `rvmon.dataflow.margins`."""
        read = [*self._readings()]
        if any("apart(" in line for line in read):
            yield "/* How far one side of a comparison is above the other, in base units. */"
            yield "static double apart(double left, double right, double factor)"
            yield "{"
            yield "    return (left == right) ? 0.0 : (left - right) * factor;"
            yield "}"
            yield ""
        yield "static void read_margins(const monitor *m, int32_t index, double *low, double *high)"
        yield "{"
        yield "    switch (index) {"
        yield from read
        yield "    default: break;"
        yield "    }"
        yield "}"

    def _readings(self) -> Iterator[str]:
        for index, plan in enumerate(self.plans):
            yield f"    case {index}:"
            for number, (_, core) in enumerate(plan.leaves):
                value, truth = self._margin(core)
                yield f"        put_margin(&low[{number}], &high[{number}], {value}, {truth});"
            yield "        break;"

    def _margin(self, core: Literal | Constant) -> tuple[str, str]:
        """How far a leaf is from the other truth, NaN where only its truth counts; and that."""
        if isinstance(core, Constant):
            return "unknown_value()", TRUTHS[TRUE if core.value else FALSE]
        state = core.proposition
        truth = f"m->truth[{self._plan.graph.index[state]}]"
        if core.sense is Sense.KNOWN_FALSE:
            return "unknown_value()", f"(({truth} == IS_FALSE) ? IS_TRUE : IS_FALSE)"
        positive = core.sense is Sense.TRUE
        text = truth if positive else f"(uint8_t)(2U - {truth})"
        if not isinstance(state.leaf, Compare) or any(
            map(self._is_label, (state.leaf.left, state.leaf.right))
        ):
            return "unknown_value()", text
        sides = (number_value(self._names, side) for side in (state.leaf.left, state.leaf.right))
        factor = real(base_factor(state.leaf, self._plan.spec))
        value = _SIGNED[state.leaf.op].format(f"apart({', '.join(sides)}, {factor})")
        return (value if positive else f"-({value})"), text

    def _is_label(self, side: Numeric) -> bool:
        """Whether a side is a label: two of them have no difference."""
        if isinstance(side, Number):
            return isinstance(side.value, str)
        signals = self._plan.spec.signals
        return isinstance(side, SignalValue) and signals[side.name].type.kind is Kind.LABEL
