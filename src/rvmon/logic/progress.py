"""Progression: steps a residual by a letter, by time alone, and to the end of the trace.

`Duals` negates residuals, which is possible where every proposition is known.

Source: AUTOMATA 1; after Bacchus and Kabanza 1998, with clock ages instead of shrinking bounds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum
from functools import cache
from typing import assert_never

from rvmon.logic import formula as mtl
from rvmon.logic.residual import FAILS, HOLDS, NO_CLOCK, Atom, Residual, both, either, substitute
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN, Lapsed, State, StateOp, Unborn

ReadLiteral = Callable[[mtl.Literal], Residual]


class Phase(Enum):
    """The position of an age relative to a window."""

    BEFORE = 0
    INSIDE = 1
    OVER = 2


def phase(node: mtl.Until | mtl.Release, age: int) -> Phase:
    """The position of an age in ticks relative to the window of `node`."""
    if age < node.low:
        return Phase.BEFORE
    return Phase.INSIDE if node.high is None or age <= node.high else Phase.OVER


def step(
    residual: Residual, ages: Sequence[int], read: ReadLiteral, limit: int | None = None
) -> Residual:
    """The residual after a position.

    In the result, clocks below `len(ages)` are the old ones, and clock `len(ages)` was started at
    this position.

    Args:
        residual: the residual before the position.
        ages: the age of each clock at this position, ticks.
        read: returns the value of a literal at this position, or the literal itself as an atom to
            keep it open.
        limit: the greatest number of clauses; `None` for no limit.

    Raises:
        TooManyClausesError: the result, or an intermediate one, may have more clauses.
    """
    stepper = _Step(ages, read, limit)
    made = {atom: stepper.atom(atom) for clause in residual for atom in clause}
    return substitute(residual, made, limit)


class _Step:
    def __init__(self, ages: Sequence[int], read: ReadLiteral, limit: int | None) -> None:
        self.ages = ages
        self.limit = limit
        self.read = read
        self.instances: dict[mtl.Core, Residual] = {}

    def atom(self, atom: Atom) -> Residual:
        node, clock = atom
        match node:
            case mtl.Literal():
                raise AssertionError("literals are read when they are instantiated")
            case mtl.Next(operand=operand):
                return self.instance(operand)
            case mtl.Until() | mtl.Release():
                age = 0 if clock == NO_CLOCK else self.ages[clock]
                return self.window(node, clock, phase(node, age))
            case _:
                assert_never(node)

    def window(self, node: mtl.Until | mtl.Release, clock: int, where: Phase) -> Residual:
        until = isinstance(node, mtl.Until)
        if where is Phase.OVER:
            return FAILS if until else HOLDS
        # `φ U ψ` is `φ ∧ pending` before its window and `ψ ∨ (φ ∧ pending)` in it; `R` is the dual.
        kept: Atom = (node, clock) if where is Phase.BEFORE else opened(node, clock)
        pending: Residual = frozenset([frozenset([kept])])
        left = self.instance(node.left)
        waiting = both(left, pending, self.limit) if until else either(left, pending)
        if where is Phase.BEFORE:
            return waiting
        right = self.instance(node.right)
        return either(right, waiting) if until else both(right, waiting, self.limit)

    def instance(self, node: mtl.Core) -> Residual:
        """The residual of `node` instantiated at this position."""
        # No `functools.cache` here: its reference cycle would keep each step in memory until the
        # garbage collector runs.
        found = self.instances.get(node)
        if found is None:
            found = self.instances[node] = self._instance(node)
        return found

    def _instance(self, node: mtl.Core) -> Residual:
        match node:
            case mtl.Constant(value=value):
                return HOLDS if value else FAILS
            case mtl.Literal():
                return self.read(node)
            case mtl.And(args=args):
                result = HOLDS
                for arg in args:
                    result = both(result, self.instance(arg), self.limit)
                return result
            case mtl.Or(args=args):
                result = FAILS
                for arg in args:
                    result = either(result, self.instance(arg))
                return result
            case mtl.Next():
                return frozenset([frozenset([(node, NO_CLOCK)])])
            case mtl.Until() | mtl.Release():
                # All formulas instantiated at one position share one clock, whatever their bounds:
                # a clock stands for the position, not for an operator.
                return self.window(node, len(self.ages), phase(node, 0))
            case mtl.Since() | mtl.Previous():
                raise AssertionError("a past operator above a future one is left to the network")
            case _:
                assert_never(node)


def instance(node: mtl.Core, read: ReadLiteral) -> Residual:
    """The residual of a formula that is instantiated at a position."""
    return _Step((), read, None).instance(node)


def opened(node: mtl.Until | mtl.Release, clock: int) -> Atom:
    """The atom inside its window: lower bound 0, and no clock if there is no upper bound."""
    return node.opened or node, NO_CLOCK if node.high is None else clock


def after(residual: Residual, ages: Sequence[int]) -> Residual:
    """The residual after time has passed without a position: closed windows are decided.

    `ages` are the present ages of its clocks, ticks.
    """
    settled: dict[Atom, Residual] = {}
    for clause in residual:
        for node, clock in clause:
            if not isinstance(node, mtl.Until | mtl.Release) or clock == NO_CLOCK:
                continue
            if phase(node, ages[clock]) is Phase.OVER:
                settled[node, clock] = FAILS if isinstance(node, mtl.Until) else HOLDS
    return substitute(residual, settled) if settled else residual


def value(residual: Residual) -> int:
    """The truth value of a prefix that leads to this residual."""
    if residual == HOLDS:
        return TRUE
    return UNKNOWN if residual else FALSE


def holds_at_end(residual: Residual, ages: Sequence[int]) -> bool:
    """Whether a result of `after` is true by the rule for the end of a trace; ages as there."""
    return any(all(_counts_at_end(atom, ages) for atom in clause) for clause in residual)


def _counts_at_end(atom: Atom, ages: Sequence[int]) -> bool:
    """Whether the atom is an unbounded `R` whose window has opened (SEMANTICS 3, The end)."""
    node, clock = atom
    if not isinstance(node, mtl.Release) or node.high is not None:
        return False
    return clock == NO_CLOCK or ages[clock] >= node.low


class Duals:
    """Builds residuals under the assumption that every proposition is known, and negates them.

    Literals of the result have the senses TRUE and FALSE only (KNOWN_FALSE is FALSE if everything
    is known), and their propositions are not Boolean combinations. A past operator above a future
    one is replaced by true in either polarity; such a result is only implied by the original.
    """

    def __init__(self) -> None:
        self._factory = mtl.Factory()
        # a formula (True) or its negation, rebuilt over known propositions
        self.of = cache(self._of)

    def affirmed(self, residual: Residual) -> Residual:
        """The residual, rebuilt over known propositions."""
        return frozenset(
            frozenset(self._atom(atom, True) for atom in clause) for clause in residual
        )

    def denied(self, residual: Residual, limit: int) -> Residual:
        """The negation of a residual, rebuilt over known propositions.

        Raises:
            TooManyClausesError: the negation may have more than `limit` clauses.
        """
        result = HOLDS
        for clause in residual:
            refuted = FAILS
            for atom in clause:
                refuted = either(refuted, frozenset([frozenset([self._atom(atom, False)])]))
            result = both(result, refuted, limit)
        return result

    def _atom(self, atom: Atom, positive: bool) -> Atom:
        node, clock = atom
        made = self.of(node, positive)
        assert isinstance(made, mtl.Literal | mtl.Next | mtl.Until | mtl.Release), "nothing folds"
        return made, clock

    def _of(self, node: mtl.Core, positive: bool) -> mtl.Core:
        match node:
            case mtl.Literal(proposition=proposition, sense=sense):
                return self._state(proposition, (sense is mtl.Sense.TRUE) is positive)
            case mtl.Since() | mtl.Previous():
                return self._factory.constant(True)
            case _:
                return self._factory.rebuilt(
                    node, lambda part: self.of(part, positive), positive=positive
                )

    def _state(self, state: State, positive: bool) -> mtl.Core:
        """A state formula, or its negation, over literals of leaves and of past operators."""
        match state.op:
            case StateOp.NOT:
                return self._state(state.args[0], not positive)
            case StateOp.AND | StateOp.OR:
                conjunction = (state.op is StateOp.AND) is positive
                join = self._factory.all_of if conjunction else self._factory.any_of
                return join(self._state(arg, positive) for arg in state.args)
            case StateOp.SURE:  # nothing is unknown
                return self._state(state.args[0], positive)
            case StateOp.LEAF if isinstance(state.leaf, Unborn | Lapsed):
                return self._factory.constant(not positive)
            case _:
                return self._factory.literal(state, mtl.Sense.TRUE if positive else mtl.Sense.FALSE)
