"""One bound of the robustness of a formula while a trace goes by, over the nodes of its network.

Source: SEMANTICS 5; Fainekos and Pappas 2009; Donze and Maler 2010; Deshmukh et al. 2017 (figures
of a part of a trace).
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence

from rvmon.dataflow.margin_joins import AllOrSome, SinceValue, UntilValue
from rvmon.dataflow.margin_nodes import End, Horizon, Operator, Rest, Told
from rvmon.dataflow.margin_windows import (
    Shifted,
    SparseShifted,
    SparseWindowExtreme,
    WindowExtreme,
)
from rvmon.dataflow.margins import INFINITE
from rvmon.dataflow.nodes import (
    Junction,
    Leaf,
    NetworkPlan,
    Node,
    Shift,
    Sweep,
    Window,
    operands_of,
)
from rvmon.dataflow.piecewise import FAR
from rvmon.formula.core import Constant

Value = tuple[int, float]
"""A position, and the robustness there."""

Letter = tuple[int, Sequence[float]]
"""A position, and what the leaves are from there on, in the order of the plan's leaves."""


class Gauge:
    """The robustness of a formula at the positions that it is asked for.

    Args:
        plan: of the formula.
        gap: ticks between two positions; `None` if only samples are positions.
        first: the first position.

    Memory: what is not settled; see `rvmon.dataflow.margin_nodes`.
    """

    def __init__(self, plan: NetworkPlan, gap: int | None, first: int) -> None:
        self.plan = plan
        self.horizon = Horizon(gap or 1, gap is None, first, first - 1)
        thin = _asked_alone(plan)
        self._fixed = _fixed(plan)
        self._operators = {
            place: self._operator(node, thin=place in thin) for place, node in plan.inner
        }
        self._values: list[float | None] = [None] * len(plan.leaves)
        self._answers = Answers(self.horizon.asked, -INFINITE)
        self._link()

    def _operator(self, node: Node, *, thin: bool) -> Operator:
        horizon = self.horizon
        fixed = {
            number: self._fixed[place]
            for number, place in enumerate(operands_of(node))
            if place in self._fixed
        }
        match node:
            case Junction():
                return AllOrSome(node, fixed, thin, horizon)
            case Window():
                return (SparseWindowExtreme if horizon.sparse else WindowExtreme)(node, horizon)
            case Shift():
                shifted = SparseShifted if horizon.sparse else Shifted
                return shifted(node, self.plan.sweep_of(node), horizon)
            case Sweep(future=True):
                return UntilValue(node, fixed, thin, horizon)
            case Sweep():
                return SinceValue(node, fixed, horizon)
            case Leaf():
                raise AssertionError("it reads a letter")

    def _link(self) -> None:
        """Have each node tell those above it."""
        plan = self.plan
        above: list[list[Told]] = [[] for _ in plan.nodes]
        above[-1].append(self._answers)
        for place, node in plan.inner:
            operator = self._operators[place]
            for operand, told in zip(operands_of(node), operator.inputs, strict=True):
                if operand not in self._fixed:
                    above[operand].append(told)
        for place, operator in self._operators.items():
            operator.out = _all(above[place])
        self._leaves = [
            (number, _all(above[place]))
            for number, (place, _) in enumerate(plan.leaves)
            if place not in self._fixed
        ]
        # These tell more as time goes by, though their operands may tell nothing more.
        self._timely = [
            self._operators[place]
            for place, node in plan.inner
            if isinstance(node, Window | Shift)
            and (node.operand in self._operators or self.horizon.gap > 1)
        ]
        self._visiting = [
            operator
            for operator in self._operators.values()
            if isinstance(operator, SparseWindowExtreme | SparseShifted)
        ]

    def copy(self) -> Gauge:
        """The same, independent from now on."""
        made = Gauge.__new__(Gauge)
        made.plan, made.horizon, made._fixed = self.plan, self.horizon.copy(), self._fixed
        made._values = list(self._values)
        made._operators = {
            place: operator.copy(made.horizon) for place, operator in self._operators.items()
        }
        made._answers = Answers(made.horizon.asked, self._answers.value)
        made._link()
        return made

    def visit(self, position: int) -> None:
        """Come to a position."""
        for operator in self._visiting:
            operator.visit(position)

    def ask(self, position: int) -> None:
        """Want the value at a position of which the letter is not known yet."""
        asked = self.horizon.asked
        if not asked or asked[-1] < position:
            asked.append(position)

    def take(self, letters: Sequence[Letter], now: int, reached: int) -> list[Value]:
        """Let the leaves be known up to an integer.

        Args:
            letters: those that are new, in order, not behind `now`.
            now: the integer.
            reached: the instant that time has come to, ticks.

        Returns:
            The values that are asked for and became settled, in order.
        """
        self.horizon.now, self.horizon.reached = now, reached
        self._read(letters, now)
        for operator in self._timely:
            operator.go()
        return self._answers.taken()

    def _read(self, letters: Sequence[Letter], now: int) -> None:
        own, sparse = self._values, self.horizon.sparse
        if not letters:
            for _, told in self._leaves:
                told.cover(now)
        for index, (start, values) in enumerate(letters):
            right = letters[index + 1][0] - 1 if index + 1 < len(letters) else now
            for number, told in self._leaves:
                value = values[number]
                if value == own[number] and not sparse:
                    told.cover(right)
                else:
                    own[number] = value
                    told.push(start, value, right)

    def finish(self, letters: Sequence[Letter], end: int, reached: int, rest: Rest) -> list[Value]:
        """End the trace; returns the values that are asked for and were not settled.

        Args:
            letters: as for `take`.
            end: the last instant, ticks.
            reached: the instant that time has come to.
            rest: what is assumed of what lies behind the end.
        """
        last = FAR if self.horizon.sparse else end // self.horizon.gap
        self.horizon.now, self.horizon.reached = last, reached
        self._read(letters, last)
        for operator in self._operators.values():
            operator.end(End(end, last, rest))
        return self._answers.taken()


class Answers:
    """Takes the values of a formula where they are asked for.

    Args:
        asked: the positions, ascending; those that are answered are taken out.
        value: what was told last.
    """

    def __init__(self, asked: list[int], value: float) -> None:
        self._asked = asked
        self.value = value
        self._found: list[Value] = []

    def push(self, start: int, value: float, right: int) -> None:
        """See `Told`."""
        if self._asked and self._asked[0] < start:
            self.cover(start - 1)
        self.value = value
        self.cover(right)

    def cover(self, right: int) -> None:
        """See `Told`."""
        asked = self._asked
        if asked and asked[0] <= right:
            index = bisect_right(asked, right)
            self._found += [(position, self.value) for position in asked[:index]]
            del asked[:index]

    def taken(self) -> list[Value]:
        """What was found since the last time."""
        found, self._found = self._found, []
        return found


class _Several:
    """Tells several what it is told."""

    def __init__(self, told: Sequence[Told]) -> None:
        self._told = told

    def push(self, start: int, value: float, right: int) -> None:
        """See `Told`."""
        for one in self._told:
            one.push(start, value, right)

    def cover(self, right: int) -> None:
        """See `Told`."""
        for one in self._told:
            one.cover(right)


def _all(told: Sequence[Told]) -> Told:
    return told[0] if len(told) == 1 else _Several(told)


def _fixed(plan: NetworkPlan) -> Mapping[int, float]:
    """The leaves that never change, where all that read them read others as well."""
    found = {
        place: INFINITE if core.value else -INFINITE
        for place, core in plan.leaves
        if isinstance(core, Constant)
    }
    for node in plan.nodes:
        operands = operands_of(node)
        if all(place in found for place in operands):
            for place in operands:
                found.pop(place, None)
    found.pop(len(plan.nodes) - 1, None)
    return found


def _asked_alone(plan: NetworkPlan) -> set[int]:
    """The nodes whose value matters only at the positions that the formula is asked for at."""
    alone, elsewhere = {len(plan.nodes) - 1}, set[int]()
    for place in range(len(plan.nodes) - 1, -1, -1):
        node = plan.nodes[place]
        joins = isinstance(node, Junction) and place in alone - elsewhere
        (alone if joins else elsewhere).update(operands_of(node))
    return alone - elsewhere
