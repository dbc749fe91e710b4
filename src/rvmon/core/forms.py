"""The formulas that no automaton judges, as operators of a network."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import IntEnum, auto
from typing import assert_never

from rvmon.core.sections import Listed, Section, Sections
from rvmon.logic.chain import Chain, reach_of
from rvmon.logic.formula import Constant, Literal, Sense
from rvmon.logic.network_plan import Junction, Leaf, NetworkPlan, Node, Shift, Sweep, Window
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN, State

_FARTHEST = (1 << 62) - 2
"""No two instants of a trace that need to be told apart are farther from each other."""

_NEVER = (1 << 63) - 1

_PAST = -1
"""In the place of the deadline of a window."""

_WORSE, _BETTER = 1, 2


class Operator(IntEnum):
    """Kinds of operators."""

    LEAF = 0
    JUNCTION = auto()
    WINDOW = auto()
    SHIFT = auto()
    UNTIL = auto()
    SINCE = auto()


def add_form(
    sections: Sections, plan: NetworkPlan, chain: Chain | None, index: Mapping[State, int]
) -> int:
    """Add a formula; returns its place.

    Args:
        sections: of the plan.
        plan: of the formula.
        chain: that it is; `None`: it is none.
        index: the places of propositions.
    """
    operators = add_operators(sections, plan, index)
    own: tuple[int, ...] = (*sections.listed(()), -1, -1, -1)
    if chain is not None:
        ends = (-1 if place is None else place for place in (chain.left, chain.excused))
        own = (*sections.listed(chain.places), chain.base, *ends)
    reach = reach_of(plan)
    ticks = _NEVER if reach is None else min(reach, _FARTHEST)
    return sections.add(
        Section.FORMS, ticks, *operators, len(plan.leaves), plan.looks_back, *own, 0
    )


def add_operators(sections: Sections, plan: NetworkPlan, index: Mapping[State, int]) -> Listed:
    """Add the nodes of a formula; see `add_form`."""
    first = sections.count(Section.OPERATORS)
    leaves = 0
    for node in plan.nodes:
        _add(sections, plan, node, leaves, index)
        leaves += isinstance(node, Leaf)
    return first, len(plan.nodes)


def _add(
    sections: Sections, plan: NetworkPlan, node: Node, leaves: int, index: Mapping[State, int]
) -> None:
    def add(
        kind: Operator,
        left: int = -1,
        right: int = -1,
        *,
        turned: bool = False,
        kept: bool = False,
        ticks: tuple[int, int, int] = (0, 0, 0),
        operands: Sequence[int] = (),
        values: Sequence[int] = (0, 0, 0),
    ) -> None:
        bounded = (max(-_FARTHEST, min(one, _FARTHEST)) for one in ticks)
        listed = sections.listed(operands)
        how = kind, turned, kept, left, right
        sections.add(Section.OPERATORS, *bounded, *how, *listed, *values)

    match node:
        case Leaf(core=core):
            place = -1 if isinstance(core, Constant) else index[core.proposition]
            add(Operator.LEAF, leaves, place, values=_values(core))
        case Junction(operands=operands, every=every):
            add(Operator.JUNCTION, turned=every, operands=operands)
        case Window(operand=operand, low=low, high=high, every=every, over=over):
            ticks = low, high, _PAST if over is None else over
            add(Operator.WINDOW, operand, turned=every, ticks=ticks)
        case Sweep(left=left, right=right, future=future, dual=dual, kept=kept):
            kind = Operator.UNTIL if future else Operator.SINCE
            add(kind, left, right, turned=dual, kept=kept)
        case Shift(operand=operand, offset=offset, opens=opens):
            kept = plan.sweep_of(node).kept
            add(Operator.SHIFT, operand, kept=kept, ticks=(offset, offset, opens))
        case _:
            assert_never(node)


def _values(core: Literal | Constant) -> list[int]:
    """What a leaf counts as where its proposition is FALSE, UNKNOWN and TRUE."""
    if isinstance(core, Constant):
        return [(_WORSE + _BETTER) * core.value] * 3
    wanted = TRUE if core.sense is Sense.TRUE else FALSE
    unknown = 0 if core.sense is Sense.KNOWN_FALSE else _BETTER
    return [
        unknown if value == UNKNOWN else (_WORSE + _BETTER) * (value == wanted)
        for value in (FALSE, UNKNOWN, TRUE)
    ]
