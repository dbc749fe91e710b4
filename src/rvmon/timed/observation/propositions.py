"""What the propositions of a requirement are in the states and actions of a network."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from rvmon.logic.letters import Alphabet
from rvmon.logic.state_formula import FALSE, TRUE, Lapsed, Lost, StateOp, Unborn
from rvmon.logic.state_formula import State as Proposition
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

Reader = Callable[[State, tuple[str, ...]], bool]
"""Whether a proposition holds in a state, at an action with some names (none: between actions)."""


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
        self._readers: dict[Proposition, Reader] = {}

    def reader(self, proposition: Proposition) -> Reader:
        """What reads a proposition off the network.

        Raises:
            NotExpressibleError: it names an unknown signal or event, or looks into the past.
        """
        found = self._readers.get(proposition)
        if found is None:
            found = self._readers[proposition] = self._new(proposition)
        return found

    def _new(self, proposition: Proposition) -> Reader:
        args = [self.reader(argument) for argument in proposition.args]
        match proposition.op, proposition.leaf:
            case StateOp.NOT, _:
                return lambda state, labels: not args[0](state, labels)
            case StateOp.AND, _:
                return lambda state, labels: all(arg(state, labels) for arg in args)
            case StateOp.OR, _:
                return lambda state, labels: any(arg(state, labels) for arg in args)
            case StateOp.SURE, _:  # nothing is unknown
                return args[0]
            case StateOp.LEAF, Constant(value=value):
                return lambda _state, _labels: value
            case StateOp.LEAF, Unborn() | Lost() | Lapsed():  # nor is anything unborn
                return lambda _state, _labels: False
            case StateOp.LEAF, SignalAtom(name=name):
                signal = self._signal(name)
                return lambda state, _labels: bool(signal(state))
            case StateOp.LEAF, EventAtom(name=name):
                if name not in self._labels:
                    raise NotExpressibleError(f"the network has no action `{name}`")
                return lambda _state, labels: name in labels
            case StateOp.LEAF, Compare(op=op, left=left, right=right):
                one, other = self._number(left), self._number(right)
                return lambda state, _labels: bool(op.holds(one(state), other(state)))
            case StateOp.LEAF, _:
                raise NotExpressibleError("it speaks of updates or of the trace's ends")
            case _:
                raise NotExpressibleError("it speaks of the past")

    def _number(self, number: Numeric) -> Callable[[State], float]:
        match number:
            case SignalValue(name):
                return self._signal(name)
            case Literal(int() | float() as value):
                return lambda _state: value
            case _:
                raise NotExpressibleError("it calculates with numbers")

    def _signal(self, name: str) -> Callable[[State], int]:
        if name not in self._signals:
            fix = f"`--bind '{name}=…'` gives it a meaning"
            raise NotExpressibleError(f"the network has no signal `{name}`: {fix}")
        read = self._signals[name]
        return lambda state: read(state.vector.locations, state.values)

    def letter(self, alphabet: Alphabet, state: State, labels: tuple[str, ...]) -> int:
        """The letter of a state, or of an action that leads to it."""
        return sum(
            entries[TRUE if self.reader(proposition)(state, labels) else FALSE]
            for proposition, entries in zip(
                alphabet.propositions, alphabet.pessimistic, strict=True
            )
        )
