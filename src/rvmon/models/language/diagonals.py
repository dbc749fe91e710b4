"""Removes constraints that zones do not support: diagonals, and lower bounds in invariants.

While time passes, the truth of `x − y <= c` does not change; only an edge that sets x or y changes
it. After an edge sets x to v, it holds if and only if `y >= v − c`. So a variable keeps the truth
of the diagonal, and each such edge is split into two: one with that guard and one with its
negation. The result has no diagonal constraints, and has the same runs. Zones with diagonals would
need other searches, since the abstractions used here are not sound for them.

A clock only grows while a location is occupied. A lower bound that holds on entry therefore stays
true, unless another automaton sets the clock, and is moved to the edges that lead to the location.

Source: Bérard, Petit, Diekert, Gastin, Characterization of the Expressive Power of Silent
Transitions in Timed Automata, Fundamenta Informaticae 36, 1998, section 4.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models.language import syntax
from rvmon.models.network import Automaton, Channel, Clock, Edge
from rvmon.models.network import expressions as ex
from rvmon.models.network.guards import normal_form, parts_of, resets_in


@dataclass(frozen=True, slots=True)
class Diagonal:
    """`clock first − clock second <= number`, or `<` if strict."""

    first: int
    second: int
    number: int
    strict: bool

    def holds(self, difference: int) -> bool:
        """Whether the constraint holds for clocks with this difference."""
        return difference < self.number if self.strict else difference <= self.number


@dataclass(slots=True)
class Diagonals:
    """The diagonal constraints of a model, each kept in a variable."""

    # clocks and variables of the model declared so far
    clocks: Sequence[Clock]
    variables: list[ex.Variable]
    # the index of the variable of each constraint, and the place where it was first written
    places: dict[Diagonal, tuple[int, Span]] = field(default_factory=dict)

    def compare(
        self, first: int, second: int, op: ex.BinaryOp, number: int, span: Span
    ) -> ex.Expression:
        """`first − second` compared with a number, as a condition on such variables."""
        match op:
            case ex.BinaryOp.LE | ex.BinaryOp.LT:
                return self._kept(Diagonal(first, second, number, op is ex.BinaryOp.LT), span)
            case ex.BinaryOp.GE | ex.BinaryOp.GT:
                kept = self._kept(Diagonal(first, second, number, op is ex.BinaryOp.GE), span)
                return ex.UnaryOperation(ex.UnaryOp.NOT, kept)
            case ex.BinaryOp.NE:
                same = self.compare(first, second, ex.BinaryOp.EQ, number, span)
                return ex.UnaryOperation(ex.UnaryOp.NOT, same)
            case _:
                least = self.compare(first, second, ex.BinaryOp.GE, number, span)
                most = self.compare(first, second, ex.BinaryOp.LE, number, span)
                return ex.BinaryOperation(ex.BinaryOp.AND, least, most)

    def _kept(self, diagonal: Diagonal, span: Span) -> ex.Expression:
        if diagonal not in self.places:
            self.places[diagonal] = len(self.variables), span
            # In names of variables brackets mean indices.
            name = self._text(diagonal).replace("[", "(").replace("]", ")")
            self.variables.append(ex.Variable(name, 0, 1, int(diagonal.holds(0)), is_bool=True))
        return ex.VariableValue(ex.Slot(self.places[diagonal][0]))

    def _text(self, diagonal: Diagonal) -> str:
        first, second = (self.clocks[clock].name for clock in (diagonal.first, diagonal.second))
        return f"{first} - {second} {'<' if diagonal.strict else '<='} {diagonal.number}"

    def are_read(self, expression: ex.Expression) -> bool:
        """Whether an expression reads one of these variables."""
        places = {place for place, _ in self.places.values()}
        parts = (part for part in parts_of(expression) if isinstance(part, ex.VariableValue))
        return any(part.slot.first in places for part in parts)

    def kept_up(self, automata: Sequence[Automaton]) -> Iterator[Automaton]:
        """The automata with edges that keep the variables up to date."""
        for diagonal, (_, span) in self.places.items():
            self._refuse_meetings(diagonal, automata, span)
        for automaton in automata:
            edges = list(automaton.edges)
            for diagonal in self.places:
                edges = [part for edge in edges for part in self._apart(edge, diagonal)]
            yield replace(automaton, edges=tuple(edges))

    def _refuse_meetings(
        self, diagonal: Diagonal, automata: Sequence[Automaton], span: Span
    ) -> None:
        """Refuse edges that can be taken together and set different clocks of a constraint."""
        setting = [
            (number, edge, frozenset(_values(edge, diagonal)))
            for number, automaton in enumerate(automata)
            for edge in automaton.edges
            if edge.sync is not None and _values(edge, diagonal)
        ]
        for number, edge, sets in setting:
            for other, its, own in setting:
                if number != other and sets != own and _meet(edge, its):
                    clocks = f"clocks of `{self._text(diagonal)}`"
                    message = f"{clocks} are set by edges that synchronise"
                    fix = f"set both clocks on one of the edges: {edge.text}, {its.text}"
                    raise model_error("TA008", message, span, fix)

    def _apart(self, edge: Edge, diagonal: Diagonal) -> Iterator[Edge]:
        """The edge; split in two if the other clock decides on the difference afterwards."""
        values = _values(edge, diagonal)
        match values.get(diagonal.first), values.get(diagonal.second):
            case None, None:
                yield edge
            case int(first), int(second):
                yield self._noted(edge, diagonal, diagonal.holds(first - second))
            case int(first), _:
                op = ex.ClockOp.GT if diagonal.strict else ex.ClockOp.GE
                yield from self._split(edge, diagonal, diagonal.second, op, first - diagonal.number)
            case _, int(second):
                op = ex.ClockOp.LT if diagonal.strict else ex.ClockOp.LE
                yield from self._split(edge, diagonal, diagonal.first, op, second + diagonal.number)

    def _split(
        self, edge: Edge, diagonal: Diagonal, clock: int, op: ex.ClockOp, number: int
    ) -> Iterator[Edge]:
        if number >= ex.MAX_TIME:
            raise model_error("TA007", f"a clock compared with {number}", edge.span)
        lower = op in (ex.ClockOp.GE, ex.ClockOp.GT)
        # Clocks are never negative, so such a comparison is always true or always false.
        if number < 0 or (number == 0 and op in (ex.ClockOp.GE, ex.ClockOp.LT)):
            yield self._noted(edge, diagonal, lower)
            return
        for truth in (True, False):
            compare = normal_form(ex.ClockCompare(clock, op, ex.Constant(number)), truth)
            assert isinstance(compare, ex.ClockCompare), "as its negation is"
            guard = replace(edge.guard, clocks=(*edge.guard.clocks, compare))
            text = f"{edge.text} where {self.clocks[clock].name} {compare.op} {number}"
            yield self._noted(replace(edge, guard=guard, text=text), diagonal, truth)

    def _noted(self, edge: Edge, diagonal: Diagonal, truth: bool) -> Edge:
        place, _ = self.places[diagonal]
        note = ex.Assignment(ex.Slot(place), ex.Constant(int(truth)), self.variables[place])
        return replace(edge, updates=(*edge.updates, note))


def difference(
    diagonals: Diagonals | None, first: int, second: int, op: ex.BinaryOp, number: int, span: Span
) -> ex.Expression:
    """`first − second` compared with a number; refused without `diagonals`."""
    if diagonals is None:
        fix = "ask for it with --query, which adds edges that keep track of it"
        message = "two clocks are compared where edges cannot keep track of their difference"
        raise model_error("TA008", message, span, fix)
    return diagonals.compare(first, second, op, number, span)


def terms_of(written: syntax.Expression, sign: int = 1) -> Iterator[tuple[int, syntax.Expression]]:
    """The terms of a sum, each with its sign (1 or −1)."""
    match written:
        case syntax.Binary(ex.BinaryOp.ADD | ex.BinaryOp.SUB as op, left, right):
            yield from terms_of(left, sign)
            yield from terms_of(right, sign if op is ex.BinaryOp.ADD else -sign)
        case _:
            yield sign, written


def _values(edge: Edge, diagonal: Diagonal) -> dict[int, int]:
    """The values to which an edge sets the clocks of a constraint."""
    found: dict[int, int] = {}
    for reset in resets_in(edge.updates):
        if reset.clock in (diagonal.first, diagonal.second):
            is_direct = any(one is reset for one in edge.updates)
            if not (is_direct and isinstance(reset.value, ex.Constant)):
                fix = "set it to a number, in the update of the edge itself"
                message = "a clock that is compared with another one is set to a computed value"
                raise model_error("TA008", message, edge.span, fix)
            found[reset.clock] = reset.value.value
    return found


def _meet(edge: Edge, other: Edge) -> bool:
    """Whether two edges of different automata can be taken together."""
    if edge.sync is None or other.sync is None or (edge.sync.sends and other.sync.sends):
        return False
    one, its = edge.sync.slot, other.sync.slot
    return one.first < its.first + its.size and its.first < one.first + one.size


_LOWER = (ex.ClockOp.GE, ex.ClockOp.GT)


def without_lower_bounds(
    automata: Sequence[Automaton], channels: Sequence[Channel]
) -> tuple[Automaton, ...]:
    """The automata with invariants that only bound clocks from above, and with the same runs."""
    return tuple(
        _without(automaton, [a for a in automata if a is not automaton], channels)
        for automaton in automata
    )


def _without(
    automaton: Automaton, others: Sequence[Automaton], channels: Sequence[Channel]
) -> Automaton:
    lower = [
        [bound for bound in place.invariant.clocks if bound.op in _LOWER]
        for place in automaton.locations
    ]
    if not any(lower):
        return automaton
    for place, bounds in zip(automaton.locations, lower, strict=True):
        for bound in bounds:
            if not isinstance(bound.bound, ex.Constant):
                raise _refusal("the lower bound of this invariant is not constant", place.span)
            sets = (r for a in others for e in a.edges for r in resets_in(e.updates))
            if any(bound.clock == reset.clock for reset in sets):
                message = "an invariant bounds a clock from below that another automaton sets"
                raise _refusal(message, place.span)
    start = automaton.locations[automaton.initial]
    if any(not _holds(bound, 0) for bound in lower[automaton.initial]):
        message = "an invariant of the initial location is false at time 0"
        raise model_error("TA014", message, start.span, "weaken it, or start elsewhere")
    edges = [_guarded(edge, lower[edge.target], channels) for edge in automaton.edges]
    locations = []
    for place in automaton.locations:
        upper = tuple(bound for bound in place.invariant.clocks if bound.op not in _LOWER)
        locations.append(replace(place, invariant=replace(place.invariant, clocks=upper)))
    kept = tuple(edge for edge in edges if edge is not None)
    return replace(automaton, locations=tuple(locations), edges=kept)


def _refusal(message: str, span: Span | None) -> Exception:
    return model_error("TA009", message, span, "put it on the guards of the edges that lead here")


def _holds(bound: ex.ClockCompare, value: int) -> bool:
    assert isinstance(bound.bound, ex.Constant), "checked by the caller"
    return value >= bound.bound.value + (bound.op is ex.ClockOp.GT)


def _guarded(
    edge: Edge, bounds: Sequence[ex.ClockCompare], channels: Sequence[Channel]
) -> Edge | None:
    """The edge with guards such that the bounds hold after it; `None` if they never do."""
    added: list[ex.ClockCompare] = []
    for bound in bounds:
        resets = [reset for reset in resets_in(edge.updates) if reset.clock == bound.clock]
        if not resets:
            added.append(bound)
            continue
        value = resets[-1].value
        if not isinstance(value, ex.Constant) or resets[-1] not in edge.updates:
            message = "an invariant bounds from below a clock that is set to a computed value"
            raise _refusal(message, edge.span)
        if not _holds(bound, value.value):
            return None
    if added and edge.sync is not None:
        channel = channels[edge.sync.slot.first]
        if channel.urgent or (channel.broadcast and not edge.sync.sends):
            message = "an invariant bounds a clock from below after an urgent or broadcast channel"
            raise _refusal(message, edge.span)
    guard = replace(edge.guard, clocks=(*edge.guard.clocks, *added))
    return replace(edge, guard=guard)
