"""What state formulas come to once all signals were born: less is asked of them then.

Where a signal may be unborn, a formula is read in two or three ways (SEMANTICS, section 1), each
with nodes of its own. From the birth of the signals on the readings are the same, and what tells
of birth is a constant.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from rvmon.codegen.unit_plan import Plan
from rvmon.formula.numeric import signals_of
from rvmon.formula.state import JOINING, UNKNOWN, State, StateOp, Unborn
from rvmon.runtime.values import FALSE, TRUE
from rvmon.spec.checked.formula import Compare, Constant, SignalAtom


@dataclass(frozen=True, slots=True)
class Grown:
    """What holds for ever of the nodes of a plan, from some position on.

    Attributes:
        last: the values that nodes come to and keep, by place.
        same: nodes that then have the value of one before them, which is in neither of the two.
        born: the signals that have to have had a value, with whether an update more.
    """

    last: Mapping[int, int] = field(default_factory=dict)
    same: Mapping[int, int] = field(default_factory=dict)
    born: Mapping[str, bool] = field(default_factory=dict)

    def operands(self, plan: Plan, place: int) -> tuple[int, ...]:
        """Those on which a node depends still."""
        if place in self.last:
            return ()
        if place in self.same:
            return (self.same[place],) if plan.graph.operands[place] else ()
        found = (self.same.get(one, one) for one in plan.graph.operands[place])
        return tuple(dict.fromkeys(one for one in found if one not in self.last))


def grown_nodes(plan: Plan) -> Grown:
    """See what becomes of the nodes of a plan.

    That a node has come to its last value is seen from its operands, which have, from its value,
    and from that it awaits no instant at which time alone would change it; that two nodes are the
    same, from what they remember. What tells that a trigger was known once is taken to come to be
    so.
    """
    graph = plan.graph
    determined = [
        graph.index[rule.determined] for rule in plan.rules if rule.determined is not None
    ]
    last = {place: TRUE for place in determined if graph.nodes[place].op is StateOp.SINCE}
    same: dict[int, int] = {}
    born: dict[str, bool] = {}
    first: dict[tuple[object, ...], int] = {}
    for place, state in enumerate(graph.nodes):
        for name, moved in _births(state):
            born[name] = born.get(name, False) or moved
        operands = Grown(last, same).operands(plan, place)
        value = _last_value(state, [last.get(one) for one in graph.operands[place]], plan.gap)
        if state.op is StateOp.AND and _are_opposed(plan, same, operands):
            value = FALSE
        if value is not None:
            last[place] = value
        if place in last:
            continue
        if state.op in JOINING:
            if len(operands) == 1:
                same[place] = operands[0]
                continue
            key: tuple[object, ...] = (state.op, frozenset(operands))
        else:
            # What has its last value is no operand any more, but it matters which one has which.
            known = [last.get(one) for one in graph.operands[place]]
            key = (state.op, state.leaf, state.low, state.high, state.pulse, operands, *known)
        other = first.setdefault(key, place)
        if other != place:
            same[place] = other
    return Grown(last, same, born)


def _are_opposed(plan: Plan, same: Mapping[int, int], places: Sequence[int]) -> bool:
    """Whether of some formula it is asked to be surely true, and surely false."""
    graph = plan.graph
    sure = {
        same.get(graph.operands[place][0], graph.operands[place][0])
        for place in places
        if graph.nodes[place].op is StateOp.SURE
    }
    denied = (graph.operands[place][0] for place in sure if graph.nodes[place].op is StateOp.NOT)
    return not sure.isdisjoint(same.get(place, place) for place in denied)


def _births(state: State) -> Iterator[tuple[str, bool]]:
    """The signals whose birth a leaf awaits, with whether an update more."""
    if isinstance(state.leaf, Unborn):
        yield from state.leaf.signals
    elif isinstance(state.leaf, SignalAtom | Compare) and state.unborn != UNKNOWN:
        yield from signals_of(state.leaf).items()


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
