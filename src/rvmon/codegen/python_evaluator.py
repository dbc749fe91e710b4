"""State formulas alone as a Python class: what judges is driven by whoever derives from it."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.codegen.python_class import node_constants, node_functions, slots, takes
from rvmon.codegen.python_nodes import NodeWriter, roles_alike
from rvmon.codegen.python_values import ValueWriter
from rvmon.codegen.python_visit import indented
from rvmon.plan.plan import Plan


def evaluator_source(plan: Plan) -> str:
    """The source of a class `Generated(Base)`, of a `Base` that derives from `Nodes`.

    Args:
        plan: has the formulas, and no rules.
    """
    return "\n".join(_lines(plan)) + "\n"


def _lines(plan: Plan) -> Iterator[str]:
    roles = roles_alike(plan)
    yield from node_functions(NodeWriter(plan, roles, {}, queued=True))
    yield "class Generated(Base):"
    yield f"    __slots__ = {slots(plan)!r}"
    yield from indented(node_constants(plan, roles))
    yield from indented(takes(ValueWriter(plan)))
