"""The robustness of a formula at all positions, over the nodes of its delay network.

Source: SEMANTICS 5; Fainekos and Pappas 2009; Donze and Maler 2010.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import assert_never

from rvmon.dataflow.nodes import Junction, Leaf, Node, Plan, Shift, Sweep, Window, operands_of
from rvmon.dataflow.pieces import FAR
from rvmon.dataflow.positions import Positions
from rvmon.dataflow.steps import (
    INFINITE,
    Steps,
    at_positions,
    constant,
    extreme,
    moved,
    negated,
    over_window,
    replaced,
    since,
    until,
)


class Rest(Enum):
    """What is assumed of the part of an operator that lies behind the end of the trace."""

    LEAST = "least"
    GREATEST = "greatest"
    END = "end"
    """The rule for the end: the greatest for an unbounded `R` that has begun, else the least."""


@dataclass(frozen=True, slots=True)
class Horizon:
    """How much of a trace is known.

    Attributes:
        positions: all of them.
        end: the last instant.
        reached: the instant that time has come to.
    """

    positions: Positions
    end: int
    reached: int


def robustness(plan: Plan, leaves: Sequence[Steps], known: Horizon, rest: Rest) -> Steps:
    """The robustness of the plan's formula at each position.

    Args:
        plan: of the formula.
        leaves: the robustness of each of its leaves, in the plan's order.
        known: how much of the trace is known.
        rest: what is assumed of the rest.

    Cost: a pass over the steps per node.
    """
    evaluating = _Evaluating(known, rest)
    given = {place: steps for (place, _), steps in zip(plan.leaves, leaves, strict=True)}
    made: list[Steps] = []
    for place, node in enumerate(plan.nodes):
        if isinstance(node, Leaf):
            made.append(given[place])
        else:
            made.append(evaluating.node(node, [made[operand] for operand in operands_of(node)]))
    return made[-1]


class _Evaluating:
    def __init__(self, known: Horizon, rest: Rest) -> None:
        self.known = known
        self.rest = rest
        self.pending = INFINITE if rest is Rest.GREATEST else -INFINITE

    def node(self, node: Node, operands: Sequence[Steps]) -> Steps:
        match node:
            case Leaf():
                raise ValueError("leaves are given")
            case Junction(every=every):
                result = operands[0]
                for operand in operands[1:]:
                    result = extreme(result, operand, greatest=not every)
                return result
            case Window():
                return self._window(node, operands[0])
            case Shift(offset=offset, opens=opens):
                result = moved(operands[0], offset)
                if self.rest is not Rest.END:
                    return result
                last = (self.known.end - opens) // self.known.positions.gap
                return replaced(result, last + 1, FAR, -INFINITE)
            case Sweep(dual=dual):
                return self._sweep(node, *(negated(o) if dual else o for o in operands))
            case _:
                assert_never(node)

    def _window(self, node: Window, operand: Steps) -> Steps:
        nothing = INFINITE if node.every else -INFINITE
        if node.low > node.high:
            result = constant(nothing)
        else:
            there = at_positions(operand, self.known.positions, nothing)
            result = over_window(there, node.low, node.high, greatest=not node.every)
        if node.over is None:
            return result
        last = (self.known.reached - node.over) // self.known.positions.gap
        ahead = constant(self.pending)
        whole = extreme(result, ahead, greatest=not node.every)
        return _joined(result, whole, last)

    def _sweep(self, node: Sweep, left: Steps, right: Steps) -> Steps:
        """As `until` or `since`, of negated operands for a dual one, whose result is negated."""
        stays = at_positions(left, self.known.positions, INFINITE)
        meets = at_positions(right, self.known.positions, -INFINITE)
        if not node.future:
            found = since(stays, meets)
        else:
            kept = self.rest is Rest.END and node.kept
            tail = INFINITE if kept else self.pending
            found = until(stays, meets, -tail if node.dual else tail)
        return negated(found) if node.dual else found


def _joined(first: Steps, second: Steps, last: int) -> Steps:
    """One function up to `last`, another one behind it."""
    before = [(left, min(right, last), value) for left, right, value in first if left <= last]
    behind = [(max(left, last + 1), r, value) for left, r, value in second if r > last]
    return [*before, *behind]
