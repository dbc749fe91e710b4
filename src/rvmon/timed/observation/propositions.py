"""What the propositions of a requirement are in the states and actions of a network."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from math import ceil, floor

from rvmon.logic.state_formula import Lapsed, Lost, StateOp, Unborn
from rvmon.logic.state_formula import State as Proposition
from rvmon.spec.checked.formula import (
    Compare,
    CompareOp,
    Constant,
    EventAtom,
    Literal,
    Numeric,
    SignalAtom,
    SignalValue,
)
from rvmon.timed.model.expressions import FALSE, BinaryOperation, Expression, UnaryOperation
from rvmon.timed.model.expressions import Constant as Number
from rvmon.timed.model.guards import either, together
from rvmon.timed.model.operators import BinaryOp, UnaryOp


class NotExpressibleError(Exception):
    """A requirement speaks of what the network does not have; the message says of what."""


def events_of(proposition: Proposition) -> Iterator[str]:
    """The events that occur in a proposition."""
    if isinstance(proposition.leaf, EventAtom):
        yield proposition.leaf.name
    for argument in proposition.args:
        yield from events_of(argument)


class Labelling:
    """Propositions as expressions over a network.

    Args:
        signals: how each signal is read off locations and variables.
        event: whether an action has a name, or what that is between actions.
    """

    def __init__(
        self, signals: Mapping[str, Expression], event: Callable[[str], Expression]
    ) -> None:
        self._signals = signals
        self._event = event

    def expression(self, proposition: Proposition) -> Expression:
        """A proposition of a state, or of an action that leads to it.

        Raises:
            NotExpressibleError: it names an unknown signal, or looks into the past.
        """
        args = [self.expression(argument) for argument in proposition.args]
        match proposition.op, proposition.leaf:
            case StateOp.NOT, _:
                return UnaryOperation(UnaryOp.NOT, args[0])
            case StateOp.AND, _:
                return together(args)
            case StateOp.OR, _:
                return either(args)
            case StateOp.SURE, _:  # nothing is unknown
                return args[0]
            case StateOp.LEAF, Constant(value=value):
                return Number(int(value))
            case StateOp.LEAF, Unborn() | Lost() | Lapsed():  # nor is anything unborn
                return FALSE
            case StateOp.LEAF, SignalAtom(name=name):
                return self._signal(name)
            case StateOp.LEAF, EventAtom(name=name):
                return self._event(name)
            case StateOp.LEAF, Compare(op=op, left=left, right=right):
                return self._comparison(op, left, right)
            case StateOp.LEAF, _:
                raise NotExpressibleError("it speaks of updates or of the trace's ends")
            case _:
                raise NotExpressibleError("it speaks of the past")

    def _comparison(self, op: CompareOp, left: Numeric, right: Numeric) -> Expression:
        match left, right:
            case Literal(int() | float() as one), Literal(int() | float() as other):
                return Number(int(op.holds(one, other)))
            case Literal(), _:
                return self._comparison(op.mirrored, right, left)
            case _, Literal(float() as number) if not number.is_integer():
                if op in (CompareOp.EQ, CompareOp.NE):  # a model has whole numbers
                    return Number(int(op is CompareOp.NE))
                up = op in (CompareOp.LT, CompareOp.GE)
                return self._comparison(op, left, Literal(ceil(number) if up else floor(number)))
            case _:
                return BinaryOperation(BinaryOp(op), self._number(left), self._number(right))

    def _number(self, number: Numeric) -> Expression:
        match number:
            case SignalValue(name):
                return self._signal(name)
            case Literal(int() | float() as value):
                return Number(int(value))
            case _:
                raise NotExpressibleError("it calculates with numbers")

    def _signal(self, name: str) -> Expression:
        if name not in self._signals:
            fix = f"`--bind '{name}=…'` gives it a meaning"
            raise NotExpressibleError(f"the network has no signal `{name}`: {fix}")
        return self._signals[name]
