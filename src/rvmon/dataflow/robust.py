"""One bound of the robustness of a formula while a trace goes by, over the nodes of its network.

Source: SEMANTICS 5; Fainekos and Pappas 2009; Donze and Maler 2010; Deshmukh et al. 2017 (figures
of a part of a trace).
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy

from rvmon.dataflow.margin_nodes import Horizon, Operator, Rest, operator_of
from rvmon.dataflow.nodes import Junction, NetworkPlan, Sweep, Window, operands_of
from rvmon.dataflow.piecewise import FAR
from rvmon.dataflow.positions import Positions
from rvmon.dataflow.steps import Step, Steps

Value = tuple[int, float]
"""A position, and the robustness there."""


class Gauge:
    """The robustness of a formula at the positions that it is asked for.

    Args:
        plan: of the formula.
        gap: ticks between two positions; `None` if only samples are positions.

    Memory: what is not settled; see `rvmon.dataflow.margin_nodes`.
    """

    def __init__(self, plan: NetworkPlan, gap: int | None) -> None:
        self.plan = plan
        self.horizon = Horizon(Positions(gap))
        thin = _asked_alone(plan)
        self._operators: list[Operator | None] = [
            operator_of(node, thin=place in thin) for place, node in enumerate(plan.nodes)
        ]
        self._given = [-FAR - 1] * len(plan.nodes)
        """Per node, the integer up to which it is settled."""
        self._by_positions = {
            operand
            for node in plan.nodes
            if isinstance(node, Window | Sweep)
            for operand in operands_of(node)
        }

    def copy(self) -> Gauge:
        """The same, independent from now on."""
        made = copy(self)
        own = self.horizon
        made.horizon = Horizon(own.positions.copy(), own.now, own.reached, list(own.asked))
        made._operators = [operator and operator.copy() for operator in self._operators]
        made._given = list(self._given)
        return made

    def visit(self, position: int) -> None:
        """Come to a position."""
        self.horizon.positions.visit(position)

    def ask(self, position: int) -> None:
        """Want the value at a position of which the letter is not known yet."""
        asked = self.horizon.asked
        if not asked or asked[-1] < position:
            asked.append(position)

    def take(self, leaves: Sequence[Steps], now: int, reached: int) -> list[Value]:
        """Let the leaves be known up to an integer.

        Args:
            leaves: the steps that go on from those before, in the order of the plan's leaves.
            now: where they end.
            reached: the instant that time has come to, ticks.

        Returns:
            The values that are asked for and became settled, in order.
        """
        self.horizon.now, self.horizon.reached = now, reached
        found = self._spread(leaves)
        settled = min((self._given[place] for place in self._by_positions), default=now)
        self.horizon.positions.forget(settled + 1)
        return found

    def finish(self, leaves: Sequence[Steps], end: int, reached: int, rest: Rest) -> list[Value]:
        """End the trace; returns the values that are asked for and were not settled.

        Args:
            leaves: as `take` has them, up to `FAR`.
            end: the last instant, ticks.
            reached: the instant that time has come to.
            rest: what is assumed of what lies behind the end.
        """
        horizon = self.horizon
        horizon.positions.end(end // horizon.positions.gap)
        horizon.now, horizon.reached, horizon.end, horizon.rest = FAR, reached, end, rest
        return self._spread(leaves)

    def _spread(self, leaves: Sequence[Steps]) -> list[Value]:
        fresh: list[Steps] = [()] * len(self.plan.nodes)
        for (place, _), steps in zip(self.plan.leaves, leaves, strict=True):
            fresh[place] = steps
        for place, (node, operator) in enumerate(
            zip(self.plan.nodes, self._operators, strict=True)
        ):
            if operator is not None:
                operands = [fresh[operand] for operand in operands_of(node)]
                fresh[place] = operator.take(operands, self.horizon)
            if fresh[place]:
                self._given[place] = fresh[place][-1][1]
        return self._answers(fresh[-1])

    def _answers(self, steps: Sequence[Step]) -> list[Value]:
        asked = self.horizon.asked
        found: list[Value] = []
        for _, right, value in steps:
            while len(found) < len(asked) and asked[len(found)] <= right:
                found.append((asked[len(found)], value))
        del asked[: len(found)]
        return found


def _asked_alone(plan: NetworkPlan) -> set[int]:
    """The nodes whose value matters only at the positions that the formula is asked for at."""
    alone, elsewhere = {len(plan.nodes) - 1}, set[int]()
    for place in range(len(plan.nodes) - 1, -1, -1):
        node = plan.nodes[place]
        joins = isinstance(node, Junction) and place in alone - elsewhere
        (alone if joins else elsewhere).update(operands_of(node))
    return alone - elsewhere
