"""Formulas over propositions that are known: two-valued readings of a residual and its negation."""

from __future__ import annotations

from typing import assert_never

from rvmon.formula.core import (
    And,
    Constant,
    Core,
    Literal,
    Next,
    Or,
    Previous,
    Release,
    Sense,
    Since,
    Until,
)
from rvmon.formula.factory import Factory
from rvmon.formula.residual import FAILS, HOLDS, Atom, Residual, both, either
from rvmon.formula.state import Lapsed, State, StateOp, Unborn


class Duals:
    """Reads formulas where no proposition is unknown, so that each has a negation.

    What it makes has literals of two senses only (`is known to be false` is `is false` there), and
    their propositions are no combinations of others. What lies ahead of an operator of the past is
    taken to be as it should: with that, what it makes is not equivalent but weaker.
    """

    def __init__(self) -> None:
        self._factory = Factory()
        self._made: dict[tuple[Core, bool], Core] = {}

    def affirmed(self, residual: Residual) -> Residual:
        """The residual itself."""
        return frozenset(
            frozenset(self._atom(atom, True) for atom in clause) for clause in residual
        )

    def denied(self, residual: Residual, limit: int) -> Residual:
        """The negation of a residual.

        Raises:
            TooManyClausesError: it may have more than `limit` clauses.
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
        assert isinstance(made, Literal | Next | Until | Release)  # noqa: S101 - nothing folds
        return made, clock

    def of(self, node: Core, positive: bool) -> Core:
        """A formula or its negation."""
        key = (node, positive)
        found = self._made.get(key)
        if found is None:
            found = self._made[key] = self._of(node, positive)
        return found

    def _of(self, node: Core, positive: bool) -> Core:
        factory = self._factory
        match node:
            case Constant(value=value):
                return factory.constant(value is positive)
            case Literal(proposition=proposition, sense=sense):
                return self._state(proposition, (sense is Sense.TRUE) is positive)
            case And(args=args) | Or(args=args):
                join = factory.all_of if isinstance(node, And) is positive else factory.any_of
                return join(self.of(arg, positive) for arg in args)
            case Next(operand=operand):
                return factory.next(self.of(operand, positive))
            case (
                Until(left=left, right=right, low=low, high=high)
                | Release(left=left, right=right, low=low, high=high)
            ):
                make = factory.until if isinstance(node, Until) is positive else factory.release
                return make(self.of(left, positive), self.of(right, positive), low, high)
            case Since() | Previous():
                return factory.constant(True)
            case _:
                assert_never(node)

    def _state(self, state: State, positive: bool) -> Core:
        """A state formula as a combination of what is read off the input, or off the past."""
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
            case (
                StateOp.LEAF
                | StateOp.PREVIOUS
                | StateOp.SINCE
                | StateOp.AMOUNT
                | StateOp.PASSED
                | StateOp.DOUBT
            ):
                return self._factory.literal(state, Sense.TRUE if positive else Sense.FALSE)
            case _:
                assert_never(state.op)
