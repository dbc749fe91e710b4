"""By how much leaves hold, as a Python function over the arrays of a generated monitor."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.codegen.python_leaves import number_expression
from rvmon.dataflow.margins import base_factor
from rvmon.formula.core import Constant, Literal, Sense
from rvmon.plan.plan import Plan
from rvmon.spec.checked.formula import Compare, CompareOp
from rvmon.spec.checked.formula import Literal as Number

_SIGNED = {
    CompareOp.LT: "-",
    CompareOp.LE: "-",
    CompareOp.GT: "",
    CompareOp.GE: "",
    CompareOp.EQ: "-abs",
    CompareOp.NE: "abs",
}
"""As `rvmon.dataflow.margins.signed`."""


def margins_source(plan: Plan, leaves: Sequence[Literal | Constant]) -> str:
    """The source of a function `margins(self)`, of the monitor.

    It gives the robustness of each leaf as `rvmon.dataflow.margins.margin_reader` does, and raises
    a `LookupError`, `TypeError` or `OverflowError` where one of them is no plain number.

    Args:
        plan: of the monitor.
        leaves: in the order of the result.
    """
    listed = "".join(f"{_margin(plan, leaf)}, " for leaf in leaves)
    return f"def margins(self):\n    return ({listed})\n"


def _margin(plan: Plan, leaf: Literal | Constant) -> str:
    if isinstance(leaf, Constant):
        return "INF" if leaf.value else "-INF"
    state = leaf.proposition
    truth = f"self.v[{plan.graph.index[state]}]"
    if leaf.sense is Sense.KNOWN_FALSE:
        return f"(INF if {truth} == 0 else -INF)"
    found = f"KNOWN[{truth}]"
    if isinstance(state.leaf, Compare) and not _is_of_a_label(state.leaf):
        left, right = state.leaf.left, state.leaf.right
        numbers = f"{number_expression(plan, left)} - {number_expression(plan, right)}"
        difference = f"(({numbers}) * {base_factor(state.leaf, plan.spec)!r})"
        found = f"{_SIGNED[state.leaf.op]}{difference}"
    return found if leaf.sense is Sense.TRUE else f"-{found}"


def _is_of_a_label(leaf: Compare) -> bool:
    """Whether a side is a label that is written out; two signals of labels have no difference."""
    sides = (leaf.left, leaf.right)
    return any(isinstance(side, Number) and isinstance(side.value, str) for side in sides)
