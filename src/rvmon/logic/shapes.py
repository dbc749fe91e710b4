"""Constructs one automaton per shape: formulas that differ in propositions alone share it.

Locations with different residuals stay apart, so that a run can be explained by its location.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rvmon.logic.automaton import Automaton
from rvmon.logic.construct import Budget, DoesNotCloseError, construct
from rvmon.logic.formula import (
    Constant,
    Core,
    Literal,
    Next,
    Release,
    Until,
    looks_back,
    parts_of,
)
from rvmon.logic.letters import Alphabet
from rvmon.logic.reduce import reduce
from rvmon.logic.residual import Residual


class Shapes:
    """The reduced automata of a specification, constructed once per shape."""

    def __init__(self) -> None:
        self._automata: dict[tuple[object, ...], tuple[Automaton | None, Sequence[Core]]] = {}

    def reduced(self, required: Next, alphabet: Alphabet, budget: Budget) -> Automaton | None:
        """The automaton of a formula; `None` if the formula looks back or does not close.

        It has the alphabet and residuals of the formula of this shape that came first; `residuals`
        translates them.

        Args:
            required: as for `rvmon.logic.construct.construct`.
            alphabet: the alphabet of that formula.
            budget: when to give up.
        """
        return self._found(required, alphabet, budget)[0]

    def residuals(self, required: Next, alphabet: Alphabet, budget: Budget) -> Sequence[Residual]:
        """The residual of each location of a formula's automaton, over its own propositions.

        Raises:
            ValueError: `reduced` gives no automaton for it.
        """
        automaton, nodes = self._found(required, alphabet, budget)
        if automaton is None:
            raise ValueError("it has no automaton")
        own = {id(node): mine for node, mine in zip(nodes, _nodes(required), strict=True)}
        return [_renamed(location.residual, own) for location in automaton.locations]

    def _found(
        self, required: Next, alphabet: Alphabet, budget: Budget
    ) -> tuple[Automaton | None, Sequence[Core]]:
        nodes = _nodes(required)
        if looks_back(required):
            return None, nodes
        key = (budget, *_description(nodes, alphabet))
        if key not in self._automata:
            try:
                made = reduce(construct(required, alphabet, budget), _itself)
            except DoesNotCloseError:
                made = None
            self._automata[key] = made, nodes
        return self._automata[key]


def _itself(residual: Residual) -> Residual:
    return residual


def _nodes(required: Core) -> list[Core]:
    """A formula and its subformulas, operands first."""
    found: dict[int, Core] = {}
    stack = [required]
    while stack:
        node = stack.pop()
        if node.id not in found:
            found[node.id] = node
            stack += _parts(node)
    return [found[number] for number in sorted(found)]


def _parts(node: Core) -> Iterator[Core]:
    """The operands of a node, and its `opened` form."""
    yield from parts_of(node)
    if isinstance(node, Until | Release) and node.opened is not None:
        yield node.opened


def _description(nodes: Sequence[Core], alphabet: Alphabet) -> Iterator[object]:
    """The key of a shape: the formula with numbered propositions."""
    place = {id(node): number for number, node in enumerate(nodes)}
    digits = {state: number for number, state in enumerate(alphabet.propositions)}
    for node in nodes:
        yield type(node), tuple(place[id(part)] for part in _parts(node))
        match node:
            case Constant(value=value):
                yield value
            case Literal(proposition=proposition, sense=sense):
                yield digits[proposition], sense.value
            case Until(low=low, high=high) | Release(low=low, high=high):
                yield low, high


def _renamed(residual: Residual, own: Mapping[int, Any]) -> Residual:
    """A residual over other nodes; `own` maps the `id()` of each present node to its new one."""
    return frozenset(
        frozenset((own[id(node)], clock) for node, clock in clause) for clause in residual
    )
