"""LTL3 by the textbook: what the infinite continuations of a finite word leave possible.

A tableau over truth assignments to all propositions and temporal subformulas at once; it shares no
code with the engines' forecasts, which are tested against it.

Source: Vardi and Wolper 1994 for the tableau; Bauer, Leucker and Schallhart 2011 for LTL3.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from rvmon.language.checked.formula import (
    Binary,
    BinaryOp,
    Constant,
    Formula,
    Interval,
    SignalAtom,
    Unary,
)
from rvmon.language.checked.formula import UnaryOp as Op
from rvmon.testing.law.syntax import subformulas
from tests.tools.common_fragment import to_core

Letter = frozenset[str]
"""The propositions that are true at a position."""

_EVER = (None, Interval(0, None))


@dataclass(frozen=True, slots=True)
class _State:
    """A position of an infinite word: which propositions and temporal subformulas hold there."""

    letter: Letter
    promised: tuple[bool, ...]


class Tableau:
    """Every infinite word over a formula's propositions, as paths of a graph.

    Args:
        formula: untimed, of future operators over Boolean signals.

    Raises:
        ValueError: it holds something else.

    Cost: 2 to the number of propositions and temporal operators.
    """

    def __init__(self, formula: Formula) -> None:
        self.formula = to_core(formula)
        parts = list(dict.fromkeys(reversed(list(subformulas(self.formula)))))  # operands first
        self.names = sorted({part.name for part in parts if isinstance(part, SignalAtom)})
        self.temporal = [part for part in parts if _is_temporal(part)]
        self._places = {part: place for place, part in enumerate(self.temporal)}
        self.states = [
            _State(frozenset(n for n, here in zip(self.names, truths, strict=False) if here), rest)
            for truths in product((False, True), repeat=len(self.names))
            for rest in product((False, True), repeat=len(self.temporal))
        ]
        self.after: dict[_State, list[_State]] = {state: [] for state in self.states}
        letters = {state.letter for state in self.states}
        for later in self.states:
            for letter in letters:
                self.after[self._before(letter, later)].append(later)
        self.live = self.lasting(self.after)

    @classmethod
    def of(cls, formula: Formula, most: int) -> Tableau | None:
        """The tableau of a formula; `None` if it has more than `most` temporal operators."""
        temporal = {part for part in subformulas(to_core(formula)) if _is_temporal(part)}
        return cls(formula) if len(temporal) <= most else None

    def possible(self, word: Sequence[Iterable[str]]) -> frozenset[bool]:
        """The truth values that the formula has on the infinite words that begin with `word`."""
        letters = [frozenset(letter) & frozenset(self.names) for letter in word]
        found = set()
        for wanted in (True, False):
            reached = {
                state
                for state in self.states
                if state.letter == letters[0] and self._holds(self.formula, state) is wanted
            }
            for letter in letters[1:]:
                reached = {s for r in reached for s in self.after[r] if s.letter == letter}
            if reached & self.live:
                found.add(wanted)
        return frozenset(found)

    def _before(self, letter: Letter, later: _State) -> _State:
        """The only state with a letter that `later` can follow."""
        promised: list[bool] = []
        for part in self.temporal:
            so_far = _State(letter, tuple(promised))
            match part:
                case Unary(op=Op.NEXT, operand=operand):
                    promised.append(self._holds(operand, later))
                case Unary(op=Op.EVENTUALLY, operand=operand):
                    promised.append(self._holds(operand, so_far) or self._holds(part, later))
                case Unary(op=Op.ALWAYS, operand=operand):
                    promised.append(self._holds(operand, so_far) and self._holds(part, later))
                case Binary(left=left, right=right):
                    keeps = self._holds(left, so_far) and self._holds(part, later)
                    promised.append(self._holds(right, so_far) or keeps)
                case _:
                    raise AssertionError("no other operator is temporal")
        return _State(letter, tuple(promised))

    def _holds(self, formula: Formula, state: _State) -> bool:
        match formula:
            case Constant(value=value):
                return value
            case SignalAtom(name=name):
                return name in state.letter
            case Unary(op=Op.NOT, operand=operand):
                return not self._holds(operand, state)
            case Binary(op=BinaryOp.AND, left=left, right=right):
                return self._holds(left, state) and self._holds(right, state)
            case Binary(op=BinaryOp.OR, left=left, right=right):
                return self._holds(left, state) or self._holds(right, state)
            case _:
                return state.promised[self._places[formula]]

    def _is_kept(self, part: Formula, state: _State) -> bool:
        """Whether what a state says of the far future comes true there, or is not said."""
        match part:
            case Unary(op=Op.EVENTUALLY, operand=operand):
                return self._holds(operand, state) or not self._holds(part, state)
            case Unary(op=Op.ALWAYS, operand=operand):
                return not self._holds(operand, state) or self._holds(part, state)
            case Binary(right=right):
                return self._holds(right, state) or not self._holds(part, state)
            case _:
                return True

    def begins(self, state: _State) -> bool:
        """Whether the formula holds on the words that a state stands for."""
        return self._holds(self.formula, state)

    def lasting(
        self, after: Mapping[Any, Sequence[Any]], of: Callable[[Any], _State] = lambda node: node
    ) -> set[Any]:
        """The nodes from which some infinite path comes true as its states say.

        Args:
            after: what follows on each node, of this tableau or of a product with it.
            of: the state of a node.
        """
        import networkx as nx

        graph = nx.DiGraph(after)
        live: set[Any] = set()
        for component in nx.strongly_connected_components(graph):
            has_cycle = any(graph.has_edge(node, node) for node in component)
            if (len(component) > 1 or has_cycle) and all(
                any(self._is_kept(part, of(node)) for node in component) for part in self.temporal
            ):
                live |= component
        return live.union(*(nx.ancestors(graph, node) for node in live))


def _is_temporal(part: Formula) -> bool:
    match part:
        case Constant() | SignalAtom() | Unary(op=Op.NOT):
            return False
        case Unary(op=Op.NEXT):
            return True
        case Unary(op=Op.EVENTUALLY | Op.ALWAYS, interval=interval) if interval in _EVER:
            return True
        case Binary(op=BinaryOp.AND | BinaryOp.OR):
            return False
        case Binary(op=BinaryOp.UNTIL, interval=interval) if interval in _EVER:
            return True
        case _:
            raise ValueError("not an untimed formula of future operators over Boolean signals")
