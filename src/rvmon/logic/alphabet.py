"""Letters: what a formula can tell apart of the values of its propositions."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from rvmon.logic.formula import Core, Sense, literals
from rvmon.logic.state_formula import State


class TruthValue(Enum):
    """The value of a proposition as one run takes it: an unknown one in the worse or better way."""

    FALSE = 0
    TRUE = 1
    UNKNOWN_PESSIMISTIC = 2
    UNKNOWN_OPTIMISTIC = 3


_TRUE_IN = {
    Sense.TRUE: frozenset({TruthValue.TRUE, TruthValue.UNKNOWN_OPTIMISTIC}),
    Sense.FALSE: frozenset({TruthValue.FALSE, TruthValue.UNKNOWN_OPTIMISTIC}),
    Sense.KNOWN_FALSE: frozenset({TruthValue.FALSE}),
}


def holds(sense: Sense, truth: TruthValue) -> bool:
    """Whether a literal of this sense is true where its proposition has this truth in a run."""
    return truth in _TRUE_IN[sense]


@dataclass(frozen=True, slots=True)
class Alphabet:
    """How the values of propositions make up a letter, a number below `size`.

    A letter is the sum of one entry per proposition of `pessimistic` (or `optimistic`), taken at
    the proposition's value.

    Attributes:
        propositions: in the order of their digits.
        truths: per proposition and digit, one of the truths that the formula cannot tell apart.
        strides: per proposition, the weight of its digit.
        pessimistic: per proposition, what FALSE, UNKNOWN and TRUE contribute.
        optimistic: the same with unknown taken the better way.
        size: the number of letters.
    """

    propositions: tuple[State, ...]
    truths: tuple[tuple[TruthValue, ...], ...]
    strides: tuple[int, ...]
    pessimistic: tuple[tuple[int, int, int], ...]
    optimistic: tuple[tuple[int, int, int], ...]
    size: int

    def valuation(self, letter: int) -> dict[State, TruthValue]:
        """The truth of each proposition in a letter."""
        return {
            proposition: truths[letter // stride % len(truths)]
            for proposition, truths, stride in zip(
                self.propositions, self.truths, self.strides, strict=True
            )
        }


def alphabet_of(formula: Core) -> Alphabet:
    """The least alphabet for a formula.

    A proposition read in one sense only needs two digits, unknown or not.
    """
    senses: dict[State, set[Sense]] = {}
    for literal in literals(formula):
        senses.setdefault(literal.proposition, set()).add(literal.sense)
    propositions = tuple(sorted(senses, key=lambda state: state.id))
    stride = 1
    strides, all_truths, pessimistic, optimistic = [], [], [], []
    for proposition in propositions:
        truths, digit = _digits(senses[proposition])
        strides.append(stride)
        all_truths.append(truths)
        low, high = digit[TruthValue.FALSE] * stride, digit[TruthValue.TRUE] * stride
        pessimistic.append((low, digit[TruthValue.UNKNOWN_PESSIMISTIC] * stride, high))
        optimistic.append((low, digit[TruthValue.UNKNOWN_OPTIMISTIC] * stride, high))
        stride *= len(truths)
    return Alphabet(
        propositions,
        tuple(all_truths),
        tuple(strides),
        tuple(pessimistic),
        tuple(optimistic),
        stride,
    )


def _digits(senses: set[Sense]) -> tuple[tuple[TruthValue, ...], dict[TruthValue, int]]:
    """One digit per set of truths that the senses cannot tell apart."""
    seen: dict[tuple[bool, ...], int] = {}
    truths: list[TruthValue] = []
    digit: dict[TruthValue, int] = {}
    ordered = sorted(senses, key=lambda sense: sense.value)
    for truth in TruthValue:
        look = tuple(holds(sense, truth) for sense in ordered)
        if look not in seen:
            seen[look] = len(truths)
            truths.append(truth)
        digit[truth] = seen[look]
    return tuple(truths), digit
