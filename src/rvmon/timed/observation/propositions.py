"""What the propositions of a requirement are in the states and actions of a network."""

from __future__ import annotations

from collections.abc import Mapping
from typing import assert_never

from rvmon.formula.alphabet import Alphabet
from rvmon.formula.state import FALSE, TRUE, Lapsed, Lost, StateOp, Unborn
from rvmon.formula.state import State as Proposition
from rvmon.spec.checked.formula import (
    Compare,
    Constant,
    EventAtom,
    Literal,
    Numeric,
    SignalAtom,
    SignalValue,
)
from rvmon.timed.model.evaluate import Evaluator
from rvmon.timed.zones.discrete import State


class NotExpressibleError(Exception):
    """A requirement speaks of what the network does not have; the message says of what."""


def speaks_of_events(proposition: Proposition) -> bool:
    """Whether an event occurs in a proposition."""
    return isinstance(proposition.leaf, EventAtom) or any(map(speaks_of_events, proposition.args))


class Labelling:
    """Values of propositions.

    Args:
        signals: how each signal is read off locations and variables.
        labels: the labels of the network's actions, which are its events.
    """

    def __init__(self, signals: Mapping[str, Evaluator], labels: frozenset[str]) -> None:
        self._signals = signals
        self._labels = labels

    def require(self, proposition: Proposition) -> None:
        """Refuse a proposition that the network cannot express.

        Raises:
            NotExpressibleError: it names an unknown signal or event, or looks into the past.
        """
        for argument in proposition.args:
            self.require(argument)
        match proposition.op, proposition.leaf:
            case StateOp.PREVIOUS | StateOp.SINCE | StateOp.AMOUNT | StateOp.DOUBT, _:
                raise NotExpressibleError("it speaks of the past")
            case StateOp.LEAF, SignalAtom(name=name):
                self._require_signal(name)
            case StateOp.LEAF, EventAtom(name=name):
                if name not in self._labels:
                    raise NotExpressibleError(f"the network has no action `{name}`")
            case StateOp.LEAF, Compare(left=left, right=right):
                for number in (left, right):
                    match number:
                        case SignalValue(name):
                            self._require_signal(name)
                        case Literal(int() | float()):
                            pass
                        case _:
                            raise NotExpressibleError("it calculates with numbers")
            case (StateOp.LEAF, Constant() | Unborn() | Lost() | Lapsed()) | (
                StateOp.SURE,
                _,
            ):
                pass
            case StateOp.LEAF, _:
                raise NotExpressibleError("it speaks of updates or of the trace's ends")

    def _require_signal(self, name: str) -> None:
        if name not in self._signals:
            raise NotExpressibleError(f"the network has no signal `{name}`")

    def truth(self, proposition: Proposition, state: State, labels: tuple[str, ...]) -> bool:
        """Whether a proposition holds in a state, at an action with some names (none: between)."""
        match proposition.op:
            case StateOp.NOT:
                return not self.truth(proposition.args[0], state, labels)
            case StateOp.AND:
                return all(self.truth(part, state, labels) for part in proposition.args)
            case StateOp.OR:
                return any(self.truth(part, state, labels) for part in proposition.args)
            case StateOp.LEAF:
                return self._leaf(proposition, state, labels)
            case StateOp.SURE:  # nothing is unknown
                return self.truth(proposition.args[0], state, labels)
            case StateOp.PREVIOUS | StateOp.SINCE | StateOp.AMOUNT | StateOp.DOUBT:
                raise AssertionError("refused before")
            case _:
                assert_never(proposition.op)

    def _leaf(self, proposition: Proposition, state: State, labels: tuple[str, ...]) -> bool:
        match proposition.leaf:
            case Constant(value=value):
                return value
            case Unborn() | Lost() | Lapsed():  # nor is anything unborn
                return False
            case SignalAtom(name=name):
                return bool(self._read(name, state))
            case EventAtom(name=name):
                return name in labels
            case Compare(op=op, left=left, right=right):
                return bool(op.holds(self._number(left, state), self._number(right, state)))
            case _:
                raise AssertionError("refused before")

    def _number(self, number: Numeric, state: State) -> float:
        match number:
            case Literal(int() | float() as value):
                return value
            case SignalValue(name):
                return self._read(name, state)
            case _:
                raise AssertionError("refused before")

    def _read(self, name: str, state: State) -> int:
        return self._signals[name](state.vector.locations, state.values)

    def letter(self, alphabet: Alphabet, state: State, labels: tuple[str, ...]) -> int:
        """The letter of a state, or of an action that leads to it."""
        return sum(
            entries[TRUE if self.truth(proposition, state, labels) else FALSE]
            for proposition, entries in zip(
                alphabet.propositions, alphabet.pessimistic, strict=True
            )
        )
