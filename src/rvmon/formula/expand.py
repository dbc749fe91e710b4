"""Formulas down to what is read off the input: propositions that look back are taken apart."""

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
from rvmon.formula.numeric import reads_fields
from rvmon.formula.state import UNKNOWN, State, StateOp
from rvmon.spec.checked.formula import Compare
from rvmon.spec.checked.formula import Constant as ConstantLeaf


def expanded(core: Core) -> Core:
    """The same formula, the propositions of whose literals are leaves.

    What only asks whether a proposition is known stays whole.
    """
    return _Expanding().core(core)


class _Expanding:
    def __init__(self) -> None:
        self.factory = Factory()
        self._made: dict[Core, Core] = {}

    def core(self, core: Core) -> Core:
        found = self._made.get(core)
        if found is None:
            found = self._made[core] = self._core(core)
        return found

    def _core(self, core: Core) -> Core:
        factory = self.factory
        match core:
            case Constant(value=value):
                return factory.constant(value)
            case Literal(sense=Sense.KNOWN_FALSE, proposition=state):
                return factory.literal(state, Sense.KNOWN_FALSE)
            case Literal(proposition=state, sense=sense):
                return self.state(state, sense is Sense.TRUE)
            case And(args=args):
                return factory.all_of(self.core(arg) for arg in args)
            case Or(args=args):
                return factory.any_of(self.core(arg) for arg in args)
            case Next(operand=operand):
                return factory.next(self.core(operand))
            case Previous(operand=operand, first=first):
                return factory.core_previous(self.core(operand), first=first)
            case Until(left=left, right=right, low=low, high=high):
                return factory.until(self.core(left), self.core(right), low, high)
            case Release(left=Literal(sense=Sense.KNOWN_FALSE) as over, right=right):
                # An episode: where it is over it owes nothing, however near that was.
                ended = self.core(over)
                return factory.release(ended, factory.any_of([ended, self.core(right)]), 0, None)
            case Release(left=left, right=right, low=low, high=high):
                return factory.release(self.core(left), self.core(right), low, high)
            case Since(left=left, right=right, low=low, high=high, dual=dual):
                ends = self.core(left), self.core(right)
                return factory.core_since(*ends, low, high, dual=dual)
            case _:
                assert_never(core)

    def state(self, state: State, positive: bool) -> Core:
        factory = self.factory
        match state.op:
            case StateOp.LEAF if isinstance(state.leaf, ConstantLeaf):
                return factory.constant(state.leaf.value is positive)
            case StateOp.LEAF | StateOp.SURE | StateOp.DOUBT | StateOp.AMOUNT | StateOp.PASSED:
                return factory.literal(state, Sense.TRUE if positive else Sense.FALSE)
            case StateOp.AND if _asks_what_is_known(state):
                return factory.literal(state, Sense.TRUE if positive else Sense.FALSE)
            case StateOp.NOT:
                return self.state(state.args[0], not positive)
            case StateOp.AND | StateOp.OR:
                join = factory.all_of if (state.op is StateOp.AND) is positive else factory.any_of
                return join(self.state(arg, positive) for arg in state.args)
            case StateOp.PREVIOUS:
                return factory.core_previous(
                    self.state(state.args[0], positive), first=not positive
                )
            case StateOp.SINCE:
                left, right = (self.state(arg, positive) for arg in state.args)
                return factory.core_since(left, right, state.low, state.high, dual=not positive)
            case _:
                assert_never(state.op)


def _asks_what_is_known(state: State) -> bool:
    """Whether it is `φ and not φ`, as `rvmon.formula.four` says that something is unknown."""
    args = set(state.args)
    denied = (arg.args[0] for arg in state.args if arg.op is StateOp.NOT)
    return any(
        args.issuperset(one.args if one.op is StateOp.AND else (one,))
        for one in denied
        if one.op is not StateOp.LEAF
        # Nobody else takes an atom and its negation alike before the birth of its signals.
        or (isinstance(one.leaf, Compare) and (one.unborn != UNKNOWN or reads_fields(one.leaf)))
    )
