"""A requirement seen from a network: its propositions as expressions, and its monitor's tables."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import product
from math import ceil, floor, inf
from typing import NamedTuple

from rvmon.language.checked import formula as rv
from rvmon.language.checked.formula import Constant as ConstantLeaf
from rvmon.logic.automaton import NOW, Automaton, row_of
from rvmon.logic.state_formula import Lapsed, Lost, StateOp, Unborn
from rvmon.logic.state_formula import State as Proposition
from rvmon.models.network import expressions as ex
from rvmon.models.network.guards import conjunction, disjunction


class NotExpressibleError(Exception):
    """A requirement refers to something that the network lacks; the message names it."""


def events_of(proposition: Proposition) -> Iterator[str]:
    """The events that occur in a proposition."""
    if isinstance(proposition.leaf, rv.EventAtom):
        yield proposition.leaf.name
    for argument in proposition.args:
        yield from events_of(argument)


class Labelling:
    """Propositions as expressions over a network.

    Args:
        signals: the expression of each signal over locations and variables.
        event: for the name of an event, whether the current action has it.
    """

    def __init__(
        self, signals: Mapping[str, ex.Expression], event: Callable[[str], ex.Expression]
    ) -> None:
        self._signals = signals
        self._event = event

    def expression(self, proposition: Proposition) -> ex.Expression:
        """A proposition as an expression over a state and the action that leads to it.

        Raises:
            NotExpressibleError: it names an unknown signal, or looks into the past.
        """
        args = [self.expression(argument) for argument in proposition.args]
        match proposition.op, proposition.leaf:
            case StateOp.NOT, _:
                return ex.UnaryOperation(ex.UnaryOp.NOT, args[0])
            case StateOp.AND, _:
                return conjunction(args)
            case StateOp.OR, _:
                return disjunction(args)
            case StateOp.SURE, _:  # nothing is unknown
                return args[0]
            case StateOp.LEAF, ConstantLeaf(value=value):
                return ex.Constant(int(value))
            case StateOp.LEAF, Unborn() | Lost() | Lapsed():  # nor is anything unborn
                return ex.FALSE
            case StateOp.LEAF, rv.SignalAtom(name=name):
                return self._signal(name)
            case StateOp.LEAF, rv.EventAtom(name=name):
                return self._event(name)
            case StateOp.LEAF, rv.Compare(op=op, left=left, right=right):
                return self._comparison(op, left, right)
            case StateOp.LEAF, _:
                raise NotExpressibleError("it refers to updates or to the ends of the trace")
            case _:
                raise NotExpressibleError("it refers to the past")

    def _comparison(self, op: rv.CompareOp, left: rv.Numeric, right: rv.Numeric) -> ex.Expression:
        match left, right:
            case rv.Literal(int() | float() as one), rv.Literal(int() | float() as other):
                return ex.Constant(int(op.holds(one, other)))
            case rv.Literal(), _:
                return self._comparison(op.mirrored, right, left)
            case _, rv.Literal(float() as number) if not number.is_integer():
                if op in (rv.CompareOp.EQ, rv.CompareOp.NE):  # a model has whole numbers
                    return ex.Constant(int(op is rv.CompareOp.NE))
                up = op in (rv.CompareOp.LT, rv.CompareOp.GE)
                return self._comparison(op, left, rv.Literal(ceil(number) if up else floor(number)))
            case _:
                return ex.BinaryOperation(ex.BinaryOp(op), self._number(left), self._number(right))

    def _number(self, number: rv.Numeric) -> ex.Expression:
        match number:
            case rv.SignalValue(name):
                return self._signal(name)
            case rv.Literal(int() | float() as value):
                return ex.Constant(int(value))
            case _:
                raise NotExpressibleError("it calculates with numbers")

    def _signal(self, name: str) -> ex.Expression:
        if name not in self._signals:
            fix = f"`--bind '{name}=…'` gives it a meaning"
            raise NotExpressibleError(f"the network has no signal `{name}`: {fix}")
        return self._signals[name]


MOST_CONDITIONS = 14  # limit for the conditions that a requirement reads


class _Cut(NamedTuple):
    """A boundary between regions: the next region starts at `number` units, or just after it."""

    number: int
    strict: bool  # whether the next region starts just after `number`


_Tree = int | tuple[int, "_Tree", "_Tree"]
"""A class of letters, or a proposition with the trees for its being false and true."""

Edge = tuple[int, tuple[int, ...]]
"""The target location of the monitor, and the source of each of its clocks."""

Region = tuple[int, ...]  # for each clock, the number of bounds that its age has passed

Ages = Mapping[int, tuple[int, float]]
"""For each clock, its least age and an exclusive upper limit."""


class Tables:
    """The tables of a monitor, with letters as expressions and ages in units of the network.

    Args:
        automaton: the monitor.
        propositions: expressions for the propositions of its alphabet, in the same order.
        unit: of the network, in ticks.

    Raises:
        NotExpressibleError: the monitor reads too many conditions, or a window does not end at a
            whole number of units.
    """

    def __init__(
        self, automaton: Automaton, propositions: Sequence[ex.Expression], unit: int
    ) -> None:
        if len(propositions) > MOST_CONDITIONS:
            raise NotExpressibleError(f"it reads more than {MOST_CONDITIONS} conditions")
        self._automaton = automaton
        self._propositions = propositions
        self._tree = self._classes(0, 0)
        self._cuts = [
            tuple(tuple(_cut(ticks, unit) for ticks in cuts) for cuts in location.cuts)
            for location in automaton.locations
        ]

    # Letters.

    def edge(self, location: int, region: Region, letter: int) -> Edge | None:
        """The edge for a class of letters; `None` in unreachable rows of the table."""
        automaton = self._automaton
        edge = automaton.edges[row_of(automaton, location, region) * automaton.classes + letter]
        return None if edge < 0 else (automaton.targets[edge], automaton.sources[edge])

    def edges(self, location: int, region: Region) -> Iterator[tuple[ex.Expression, Edge]]:
        """All edges from a region, each with the condition on the letter."""
        classes: dict[Edge, set[int]] = {}
        for number in range(self._automaton.classes):
            edge = self.edge(location, region, number)
            if edge is not None:
                classes.setdefault(edge, set()).add(number)
        for edge, numbers in classes.items():
            yield self.letters(numbers), edge

    def letters(self, classes: set[int]) -> ex.Expression:
        """The condition that a letter is in one of some classes."""
        return self._in(self._tree, classes)

    def class_of(self, holds: Callable[[ex.Expression], int]) -> int:
        """The class of a state's letter; `holds` gives the truth of each proposition."""
        tree = self._tree
        while not isinstance(tree, int):
            place, false, true = tree
            tree = true if holds(self._propositions[place]) else false
        return tree

    def _classes(self, place: int, letter: int) -> _Tree:
        """The decision tree from the propositions, from `place` on, to the class of a letter."""
        alphabet = self._automaton.alphabet
        if place == len(alphabet.propositions):
            return self._automaton.class_of[letter]
        low, _, high = alphabet.pessimistic[place]
        false = self._classes(place + 1, letter + low)
        true = self._classes(place + 1, letter + high)
        return false if false == true else (place, false, true)

    def _in(self, tree: _Tree, classes: set[int]) -> ex.Expression:
        if isinstance(tree, int):
            return ex.TRUE if tree in classes else ex.FALSE
        place, false, true = tree
        no, yes = self._in(false, classes), self._in(true, classes)
        test = self._propositions[place]
        if no == yes:
            return no
        if yes == ex.FALSE:
            return conjunction((negated(test), no))
        return conjunction((test, yes)) if no == ex.FALSE else ex.Choice(test, yes, no)

    # Ages.

    def regions(self, location: int, beyond: Region = ()) -> Iterator[Region]:
        """The regions of a location in which no age is before its place in `beyond`."""
        for region in product(*(range(len(cuts) + 1) for cuts in self._cuts[location])):
            if all(new >= old for new, old in zip(region, beyond, strict=False)):
                yield region

    def is_last(self, location: int, region: Region) -> bool:
        """Whether every age has passed all its bounds."""
        return all(n == len(cuts) for cuts, n in zip(self._cuts[location], region, strict=True))

    def highest(
        self, location: int, clocks: Sequence[int], region: Region
    ) -> Iterator[ex.ClockCompare]:
        """The upper bounds up to which ages stay in a region."""
        for clock, _, high in self._bounds(location, clocks, region):
            if high is not None:
                yield ex.ClockCompare(clock, ex.ClockOp.LE, ex.Constant(high.number))

    def exact(
        self, location: int, clocks: Sequence[int], region: Region
    ) -> Iterator[ex.ClockCompare]:
        """The condition that ages are in a region."""
        for clock, low, high in self._bounds(location, clocks, region):
            if low is not None:
                op = ex.ClockOp.GT if low.strict else ex.ClockOp.GE
                yield ex.ClockCompare(clock, op, ex.Constant(low.number))
            if high is not None:
                op = ex.ClockOp.LE if high.strict else ex.ClockOp.LT
                yield ex.ClockCompare(clock, op, ex.Constant(high.number))

    def just_after(
        self, location: int, clocks: Sequence[int], region: Region, ages: Ages
    ) -> Ages | None:
        """Narrow ages to those from which any delay, however short, leads into a region.

        Returns `None` if there are none. `clocks` are those in use, with `NOW` for a clock that
        starts at this instant; `region` belongs to `location`.
        """
        narrowed = dict(ages)
        for clock, below, above in self._bounds(location, clocks, region):
            low, high = narrowed.get(clock, (0, 1 if clock == NOW else inf))
            low = low if below is None else max(low, below.number)
            high = high if above is None else min(high, above.number)
            if low >= high:
                return None
            narrowed[clock] = low, high
        return narrowed

    def _bounds(
        self, location: int, clocks: Sequence[int], region: Region
    ) -> Iterator[tuple[int, _Cut | None, _Cut | None]]:
        """Each clock, with the lower and upper boundary of its region (`None`: unbounded)."""
        for clock, cuts, place in zip(clocks, self._cuts[location], region, strict=True):
            low = cuts[place - 1] if place else None
            yield clock, low, cuts[place] if place < len(cuts) else None


def bounds_of(ages: Ages) -> tuple[ex.ClockCompare, ...]:
    """The condition that clocks have the given ages; `NOW` always satisfies it."""
    bounds = []
    for clock, (low, high) in ages.items():
        if clock != NOW and low:
            bounds.append(ex.ClockCompare(clock, ex.ClockOp.GE, ex.Constant(low)))
        if clock != NOW and high < inf:
            bounds.append(ex.ClockCompare(clock, ex.ClockOp.LT, ex.Constant(int(high))))
    return tuple(bounds)


def _cut(ticks: int, unit: int) -> _Cut:
    number, rest = divmod(ticks, unit)
    if rest > 1:
        raise NotExpressibleError("a window does not end at a whole number of the model's units")
    if number >= ex.MAX_TIME:
        raise NotExpressibleError("a window has too many of the model's units")
    return _Cut(number, strict=rest == 1)


def negated(one: ex.Expression) -> ex.Expression:
    """The negation of an expression."""
    if one in (ex.TRUE, ex.FALSE):
        return ex.FALSE if one == ex.TRUE else ex.TRUE
    return ex.UnaryOperation(ex.UnaryOp.NOT, one)
