"""What state formulas come to once all signals were born: less is asked of them then.

Where a signal may be unborn, a formula is read in two or three ways (SEMANTICS, section 1). From
the birth of the signals on what depends on birth is a constant, and so is much that is made of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rvmon.formula.state import State, StateOp, Unborn
from rvmon.plan.plan import Plan
from rvmon.runtime.values import FALSE, TRUE
from rvmon.spec.checked.formula import Constant


def last_values(plan: Plan) -> Mapping[int, int]:
    """The values that nodes come to and keep, by place; nodes that go on changing are left out.

    That a node has come to it is seen from its operands, which have, from its value, and from that
    it awaits no instant at which time alone would change it. What tells that a trigger was known
    once is taken to come to be so.
    """
    graph = plan.graph
    determined = [
        graph.index[rule.determined] for rule in plan.rules if rule.determined is not None
    ]
    last = {place: TRUE for place in determined if graph.nodes[place].op is StateOp.SINCE}
    for place, state in enumerate(graph.nodes):
        value = _last_value(state, [last.get(one) for one in graph.operands[place]], plan.gap)
        if value is not None:
            last[place] = value
    return last


def _last_value(state: State, operands: Sequence[int | None], gap: int | None) -> int | None:
    match state.op:
        case StateOp.LEAF:
            if isinstance(state.leaf, Constant):
                return TRUE if state.leaf.value else FALSE
            return FALSE if isinstance(state.leaf, Unborn) else None
        case StateOp.NOT:
            (value,) = operands
            return None if value is None else TRUE - value
        case StateOp.AND:
            return FALSE if FALSE in operands else None if None in operands else TRUE
        case StateOp.OR:
            return TRUE if TRUE in operands else None if None in operands else FALSE
        case StateOp.SURE | StateOp.PREVIOUS:
            return operands[0]
        case StateOp.SINCE:
            return _last_since(state, operands, gap)
        case _:
            return None


def _last_since(state: State, operands: Sequence[int | None], gap: int | None) -> int | None:
    left, right = operands
    if right == TRUE and state.low == 0:
        return TRUE
    if left == FALSE and right is not None:
        return FALSE
    if left != TRUE or right is None:
        return None
    if right == FALSE:
        # Without a bound it keeps what it was, whatever that is.
        return None if state.high is None else FALSE
    # A window may pass over positions that are far apart.
    return TRUE if gap == 1 or state.high is None else None
