"""A network and a search goal, encoded as the plan of the native search: one array of int32.

`plan.h` describes the format.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import log

from rvmon.models import model_error
from rvmon.models.network import Edge, Guard, Network, guards
from rvmon.models.network import expressions as ex
from rvmon.models.search.budget import Policy
from rvmon.models.search.bytecode import Programs
from rvmon.models.search.clock_bounds import ClockBounds, location_bounds
from rvmon.models.search.ltl import BuchiAutomaton, BuchiState

MAGIC = 0x5A4E3031
MOST_CLOCKS = 5000
MOST_TREE_ROWS = 1000
LARGEST = (1 << 31) - 2
_OPS = {ex.ClockOp.LT: 0, ex.ClockOp.LE: 1, ex.ClockOp.GE: 2, ex.ClockOp.GT: 3}
_KINDS = {ex.LocationKind.NORMAL: 0, ex.LocationKind.URGENT: 1, ex.LocationKind.COMMITTED: 2}
_PLAIN, _AND, _OR, _NOT, _UNTIL, _STAY, _NEXT = range(7)


class Plan:
    """An encoded plan, with what its indices stand for."""

    def __init__(self, network: Network, sought: Sought) -> None:
        self._network = network
        self._programs = Programs(len(network.variables) + len(network.locals))
        self._atoms: list[int] = []
        self._limits: list[int] = []
        self._tree: list[int] = []
        self._pieces: list[int] = []
        self.edges: list[tuple[int, int]] = []  # for each edge of the plan: automaton and index
        timer = len(network.clocks)
        due: tuple[ex.ClockCompare, ...] = ()
        if sought.bound is not None and sought.kind in (Seek.GOAL, Seek.DEADLOCK):
            due = (ex.ClockCompare(timer, ex.ClockOp.LE, ex.Constant(sought.bound)),)
        self._sets = [
            {reset.clock for edge in a.edges for reset in guards.resets_in(edge.updates)}
            for a in network.automata
        ]
        # Comparisons of clocks in the query, by automaton (`None`: any) and location.
        self._query_compares: dict[int | None, dict[int, list[ex.ClockCompare]]] = {}
        # The alternatives of the goal and of the states to stay in.
        self.goal = guards.alternatives_of(sought.goal, due)
        self.inside = guards.alternatives_of(sought.inside, due)
        states = () if sought.automaton is None else sought.automaton.states
        self.inside += [
            guard
            for state in states
            for guard in guards.alternatives_of(guards.conjunction(state.label))
        ]
        goal = self._alternatives(self.goal)
        inside = self._alternatives(self.inside)
        if sought.nested is not None:
            self._add_formula(sought.nested)
        automata, locations, edges = self._automata()
        pieces, rows = len(self.inside), len(self._tree) // 4
        if timer >= MOST_CLOCKS or pieces > guards.MOST_PIECES or rows > MOST_TREE_ROWS:
            raise model_error("TA019", "the query has too many alternatives, or clocks", None)
        variables, ranks = (*network.variables, *network.locals), network.priorities
        sections = [
            (4, [x for v in variables for x in (v.low, v.high, v.initial, v.is_bool)]),
            (3, automata), (8, locations), (10, edges), (4, self._atoms), (3, self._limits),
            (1, self._programs.code), (1, self._programs.table), (3, goal), (3, inside),
            (3, self._query_limits(sought, timer + 1)), (4, self._tree), (3, self._pieces),
            (4, _buchi_rows(states)), (1, [arc for state in states for arc in state.arcs]),
            (1, [] if ranks is None else [*ranks.automata, ranks.internal, *ranks.channels]),
        ]  # fmt: skip
        late = sought.bound if sought.kind in (Seek.LATE, Seek.LATE_AFTER) else sought.progress
        choose = list(Policy).index(sought.choose)
        head = [MAGIC, sought.kind, choose, timer, sought.has_timer, sought.is_levelled]
        sets = 0 if sought.automaton is None else sought.automaton.sets
        head += [int(late or 0), sets, len(network.locals), network.is_watched]
        # the plan, and the costs of its edges as doubles, both as bytes
        self.numbers = _packed(head, sections)
        weights = (network.automata[a].edges[number].weight for a, number in self.edges)
        self.costs = array("d", (-log(weight) for weight in weights)).tobytes()

    def _automata(self) -> tuple[list[int], list[int], list[int]]:
        """The rows of automata, locations and edges. Edges are sorted by source."""
        automata: list[int] = []
        locations: list[int] = []
        edges: list[int] = []
        for index, automaton in enumerate(self._network.automata):
            automata += [len(locations) // 8, len(automaton.locations), automaton.initial]
            bounds = location_bounds(self._network, automaton, self._query_compares.get(index))
            pairs = zip(automaton.locations, automaton.leaving(), strict=True)
            for number, (place, leaving) in enumerate(pairs):
                first, limit = len(self.edges), len(self._limits) // 3
                for k in leaving:
                    edges += self._edge(index, automaton.edges[k])
                    self.edges.append((index, k))
                self._limits += _limit_rows(bounds[number])
                data = self._data(place.invariant.data)
                locations += [_KINDS[place.kind], data, *self._compares(place.invariant.clocks)]
                locations += [limit, len(self._limits) // 3 - limit]
                locations += [first, len(self.edges) - first]
        return automata, locations, edges

    def _edge(self, automaton: int, edge: Edge) -> list[int]:
        row = [automaton, edge.target, self._data(edge.guard.data)]
        row += self._compares(edge.guard.clocks)
        row.append(self._programs.add_updates(edge.updates) if edge.updates else -1)
        if edge.sync is None:
            return [*row, -1, 0, 0, edge.watches << 3]
        slot = edge.sync.slot
        channel = self._network.channels[slot.first]
        flags = edge.sync.sends | channel.broadcast << 1 | channel.urgent << 2
        last = slot.first + slot.size
        return [*row, self._programs.add_index(slot), slot.first, last, flags]

    def _data(self, expression: ex.Expression) -> int:
        return -1 if expression == ex.TRUE else self._programs.add(expression)

    def _compares(self, compares: Iterable[ex.ClockCompare]) -> tuple[int, int]:
        """Add atoms, and return the index of the first and their number."""
        first = len(self._atoms) // 4
        for compare in compares:
            row = [compare.clock + 1, _OPS[compare.op]]
            match compare.bound:
                # Most bounds are constants, with which the search compares directly.
                case ex.Constant(value) if 0 <= value <= LARGEST:
                    row += [-1, value]
                case bound:
                    row += [self._programs.add(bound), 0]
            self._atoms += row
        return first, len(self._atoms) // 4 - first

    def _alternatives(self, alternatives: Sequence[Guard]) -> list[int]:
        for alternative in alternatives:
            places = list(_places_of(alternative.data))
            for compare in alternative.clocks:
                if compare.clock == len(self._network.clocks):
                    continue  # the timer
                # Prefer a location of an automaton that resets the clock: its edges drop the bound.
                chosen = [p for p in places if compare.clock in self._sets[p[0]]] or places
                automaton, place = chosen[0] if chosen else (None, 0)
                self._query_compares.setdefault(automaton, {}).setdefault(place, []).append(compare)
        return [
            number
            for alternative in alternatives
            for number in (self._data(alternative.data), *self._compares(alternative.clocks))
        ]

    def _query_limits(self, sought: Sought, timer: int) -> list[int]:
        """The limits of the clocks that the query compares in every location."""
        everywhere = self._query_compares.get(None, {}).get(0, [])
        bounds = ClockBounds()
        bounds.note(everywhere, self._network)
        rows = _limit_rows(bounds)
        if sought.bound is not None and sought.kind in (Seek.GOAL, Seek.DEADLOCK):
            rows += [timer, 0, sought.bound]
        return rows

    def _add_formula(self, formula: ex.Expression) -> int:
        """Add rows of the tree for a normalised formula, and return the index of its root."""
        match formula:
            case ex.Deadlock():
                return self._row(_NOT, self._row(_NEXT, -1))
            case ex.UnaryOperation(ex.UnaryOp.NOT, ex.Deadlock()):
                return self._row(_NEXT, -1)
            case ex.BinaryOperation(ex.BinaryOp.AND | ex.BinaryOp.OR as op, left, right) if (
                guards.has_paths(formula) or guards.has_deadlock(formula)
            ):
                kind = _AND if op is ex.BinaryOp.AND else _OR
                return self._row(kind, self._add_formula(left), self._add_formula(right))
            case ex.PathFormula(op, body, bound, left):
                return self._path(op, self._add_formula(body), left, -1 if bound is None else bound)
            case _:
                first = len(self._pieces) // 3
                self._pieces += self._alternatives(guards.alternatives_of(formula))
                return self._row(_PLAIN, first, len(self._pieces) // 3 - first)

    def _path(self, op: ex.PathOp, body: int, until: ex.Expression, bound: int) -> int:
        left = -1 if until == ex.TRUE else self._add_formula(until)
        match op:
            case ex.PathOp.POSSIBLY:
                return self._row(_UNTIL, left, body, bound)
            case ex.PathOp.INVARIANTLY:
                return self._row(_NOT, self._row(_UNTIL, left, self._row(_NOT, body), bound))
            case ex.PathOp.POTENTIALLY_ALWAYS:
                return self._stay(body, left, bound)
            case ex.PathOp.EVENTUALLY:
                return self._row(_NOT, self._stay(self._row(_NOT, body), left, bound))
            case ex.PathOp.SOME_NEXT:
                return self._row(_NEXT, body)
            case ex.PathOp.EVERY_NEXT:
                return self._row(_NOT, self._row(_NEXT, self._row(_NOT, body)))
            case _:
                raise AssertionError(f"{op} refers to one run")

    def _stay(self, body: int, left: int, bound: int) -> int:
        """A run on which the body holds forever, or up to a state in which `left` has ended."""
        stay = self._row(_STAY, body, 0, bound)
        if left < 0:
            return stay
        ends = self._row(_AND, self._row(_NOT, left), body)
        return self._row(_OR, stay, self._row(_UNTIL, body, ends, bound))

    def _row(self, kind: int, left: int, right: int = 0, bound: int = -1) -> int:
        self._tree += (kind, left, right, bound)
        return len(self._tree) // 4 - 1


def _packed(head: Sequence[int], sections: Sequence[tuple[int, Sequence[int]]]) -> bytes:
    at = len(head) + 2 * len(sections)
    numbers = [*head]
    for width, section in sections:
        numbers += [at, len(section) // width]
        at += len(section)
    for _, section in sections:
        numbers += section
    return array("i", numbers).tobytes()


def _places_of(condition: ex.Expression) -> Iterator[tuple[int, int]]:
    """Automata, with locations in which they must be where a condition holds."""
    match condition:
        case ex.InLocation(automaton, location):
            yield automaton, location
        case ex.BinaryOperation(ex.BinaryOp.AND, left, right):
            yield from _places_of(left)
            yield from _places_of(right)


def _buchi_rows(states: Iterable[BuchiState]) -> list[int]:
    rows, arcs = list[int](), 0
    for state in states:
        rows += (state.starts, state.sets, arcs, len(state.arcs))
        arcs += len(state.arcs)
    return rows


def _limit_rows(bounds: ClockBounds) -> list[int]:
    return [
        number
        for is_lower, table in ((1, bounds.lower), (0, bounds.upper))
        for clock, limit in table.items()
        for number in (clock + 1, is_lower, min(limit, LARGEST))
    ]


class Seek(IntEnum):
    """The kinds of search, with their numbers in `plan.h`, which explains them."""

    GOAL = 0
    DEADLOCK = 1
    STAY = 2
    STAY_AFTER = 3
    LATE = 4
    LATE_AFTER = 5
    NESTED = 6
    START = 7
    RUN = 8


@dataclass(frozen=True, slots=True)
class Sought:
    """What a search looks for in a network."""

    kind: Seek
    # Formulas are normalised. For deadlocks, `goal` is required of states without and `inside` of
    # states with a deadlock.
    goal: ex.Expression | None = None  # states to reach, or after which a run must stay inside
    inside: ex.Expression | None = None  # states in which a run must stay
    nested: ex.Expression | None = None  # states to reach, or start condition, with path operators
    automaton: BuchiAutomaton | None = None  # must accept the run; of an LTL formula
    progress: bool = False  # whether time must diverge on a run that `automaton` accepts
    choose: Policy = Policy.SHORTEST
    bound: int | None = None  # in units of time

    @property
    def has_timer(self) -> bool:
        """Whether the query needs a clock of its own."""
        nested = () if self.nested is None else guards.parts_of(self.nested)
        return (
            self.bound is not None
            or self.progress
            or self.choose is Policy.FASTEST
            or any(isinstance(part, ex.PathFormula) and part.bound is not None for part in nested)
        )

    @property
    def is_levelled(self) -> bool:
        """Whether a state may only be covered by one with the same future, not by a larger one."""
        return self.kind not in (Seek.GOAL, Seek.LATE, Seek.LATE_AFTER)
