"""Constructs one automaton per shape: formulas that differ in propositions and bounds share it.

Locations with different residuals stay apart, so that a run can be explained by its location.

An automaton depends on the order of the bounds, and on their distances only where these are small:
an age that `construct` meets is 0 or a bound, plus one tick per step after it. So bounds that lie
far apart are replaced by evenly spaced ones in the same order, and put back afterwards. Without
this, hundreds of requirements with different deadlines take seven times as long to compile.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, TypeAlias, cast

from msgspec.structs import replace

from rvmon.logic import formula as mtl
from rvmon.logic.alphabet import Alphabet
from rvmon.logic.automaton import Automaton, Location
from rvmon.logic.construct import Budget, DoesNotCloseError, construct
from rvmon.logic.reduce import reduce
from rvmon.logic.residual import Residual

_APART = 1 << 10
"""The least distance in ticks between neighbouring bounds, and from 0, for them to be replaced."""

_STRIDE = 1 << 20  # the distance in ticks between the bounds that replace them

_Key: TypeAlias = tuple[object, ...]


class Shapes:
    """The reduced automata of a specification, constructed once per shape."""

    def __init__(self) -> None:
        self._shapes: dict[_Key, tuple[Automaton | None, Sequence[mtl.Core]] | None] = {}
        self._automata: dict[_Key, tuple[Automaton | None, Sequence[mtl.Core]]] = {}

    def reduced(self, required: mtl.Next, alphabet: Alphabet, budget: Budget) -> Automaton | None:
        """The automaton of a formula; `None` if the formula looks back or exceeds the budget.

        Formulas that differ only in propositions share an automaton, which has the alphabet and
        residuals of the first of them; `residuals` translates these.
        """
        return self._built(required, alphabet, budget)[0]

    def residuals(
        self, required: mtl.Next, alphabet: Alphabet, budget: Budget
    ) -> Sequence[Residual]:
        """The residual of each location of a formula's automaton, over its own propositions.

        Raises:
            ValueError: the formula has no automaton.
        """
        automaton, nodes = self._built(required, alphabet, budget)
        if automaton is None:
            raise ValueError("it has no automaton")
        own = {id(node): mine for node, mine in zip(nodes, _nodes(required), strict=True)}
        return [_renamed(location.residual, own) for location in automaton.locations]

    def _built(
        self, required: mtl.Next, alphabet: Alphabet, budget: Budget
    ) -> tuple[Automaton | None, Sequence[mtl.Core]]:
        nodes = _nodes(required)
        if mtl.looks_back(required):
            return None, nodes
        bounds = sorted({bound for node in nodes for bound in _bounds(node)})
        stand_ins = _stand_ins(bounds)
        shape = (budget, *_description(nodes, alphabet, stand_ins))
        # Two caches: automata per shape, which are expensive, and per shape and bounds, after the
        # bounds were put back.
        key = (shape, *bounds)
        if key not in self._automata:
            made = self._construct(shape, nodes, stand_ins, alphabet, budget)
            self._automata[key] = made, nodes
        return self._automata[key]

    def _construct(
        self,
        shape: _Key,
        nodes: Sequence[mtl.Core],
        stand_ins: Mapping[int, int],
        alphabet: Alphabet,
        budget: Budget,
    ) -> Automaton | None:
        if shape not in self._shapes:
            others = _with_bounds(nodes, stand_ins)
            made, steps = _constructed(others, alphabet, budget)
            is_same = all(old == new for old, new in stand_ins.items())
            # The automaton is valid for all bounds of the shape only if no age came near the next
            # stand-in by counting ticks. Clocks differ in age by at least a tick each, so the
            # oldest may lead by as many ticks as there are clocks.
            is_general = is_same or steps + budget.clocks < _APART
            self._shapes[shape] = (made, others) if is_general else None
        found = self._shapes[shape]
        if found is None:  # the distances between its bounds matter after all
            return _constructed(nodes, alphabet, budget)[0]
        automaton, others = found
        if automaton is None:
            return None
        own = {id(other): node for other, node in zip(others, nodes, strict=True)}
        return _put_back(automaton, own, {new: old for old, new in stand_ins.items()})


def _constructed(
    nodes: Sequence[mtl.Core], alphabet: Alphabet, budget: Budget
) -> tuple[Automaton | None, int]:
    """The reduced automaton of the last node, and the most ticks by which an age passed a bound."""
    ages: set[int] = set()
    try:
        whole = construct(cast("mtl.Next", nodes[-1]), alphabet, budget, ages)
        made = reduce(whole, lambda residual: residual)
    except DoesNotCloseError:
        made = None
    return made, max((age % _STRIDE for age in ages), default=0)


def _nodes(required: mtl.Core) -> list[mtl.Core]:
    """A formula and its subformulas, operands first."""
    found: dict[int, mtl.Core] = {}
    stack = [required]
    while stack:
        node = stack.pop()
        if node.id not in found:
            found[node.id] = node
            stack += _parts(node)
    return [found[number] for number in sorted(found)]


def _parts(node: mtl.Core) -> Iterator[mtl.Core]:
    """The operands of a node, and its `opened` form."""
    yield from mtl.parts_of(node)
    if isinstance(node, mtl.Until | mtl.Release) and node.opened is not None:
        yield node.opened


def _bounds(node: mtl.Core) -> Iterator[int]:
    """The ages, other than 0, at which the window of a node opens and is over."""
    if isinstance(node, mtl.Until | mtl.Release):
        if node.low:
            yield node.low
        if node.high is not None:
            yield node.high + 1


def _stand_ins(bounds: Sequence[int]) -> Mapping[int, int]:
    """The replacement of each bound; bounds whose distances matter replace themselves."""
    if any(high - low < _APART for low, high in pairwise((0, *bounds))):
        return {bound: bound for bound in bounds}
    return {bound: _STRIDE * rank for rank, bound in enumerate(bounds, start=1)}


def _description(
    nodes: Sequence[mtl.Core], alphabet: Alphabet, stand_ins: Mapping[int, int]
) -> Iterator[object]:
    """The key of a shape: the formula with numbered propositions and stand-in bounds."""
    place = {id(node): number for number, node in enumerate(nodes)}
    digits = {state: number for number, state in enumerate(alphabet.propositions)}
    for node in nodes:
        yield type(node)
        match node:
            case mtl.Constant(value=value):
                yield value
            case mtl.Literal(proposition=proposition, sense=sense):
                yield digits[proposition], sense.value
            case mtl.Until() | mtl.Release():
                yield tuple(stand_ins[bound] for bound in _bounds(node))
                yield node.low > 0, tuple(place[id(part)] for part in _parts(node))
            case _:
                yield tuple(place[id(part)] for part in _parts(node))


def _with_bounds(nodes: Sequence[mtl.Core], stand_ins: Mapping[int, int]) -> Sequence[mtl.Core]:
    """The same nodes with other bounds."""
    made: dict[int, Any] = {}
    for node in nodes:
        match node:
            case mtl.And(args=args) | mtl.Or(args=args):
                made[node.id] = replace(node, args=tuple(made[arg.id] for arg in args))
            case mtl.Next(operand=operand):
                made[node.id] = mtl.Next(node.id, made[operand.id])
            case mtl.Until() | mtl.Release():
                made[node.id] = replace(
                    node,
                    left=made[node.left.id],
                    right=made[node.right.id],
                    low=stand_ins[node.low] if node.low else 0,
                    high=None if node.high is None else stand_ins[node.high + 1] - 1,
                    opened=None if node.opened is None else made[node.opened.id],
                )
            case _:
                made[node.id] = node
    return tuple(made.values())


def _renamed(residual: Residual, own: Mapping[int, Any]) -> Residual:
    """A residual over other nodes; `own` maps the `id()` of each present node to its new one."""
    return frozenset(
        frozenset((own[id(node)], clock) for node, clock in clause) for clause in residual
    )


def _put_back(automaton: Automaton, own: Mapping[int, Any], bounds: Mapping[int, int]) -> Automaton:
    """An automaton with stand-in nodes and bounds replaced by those of the actual formula."""
    locations = tuple(
        Location(
            _renamed(location.residual, own),
            tuple(tuple(bounds[cut] for cut in cuts) for cuts in location.cuts),
        )
        for location in automaton.locations
    )
    return replace(automaton, locations=locations)
