"""A network of timed automata with all names resolved: the starting point of every algorithm here.

Clocks, variables, channels, automata, locations and edges are referred to by their index in the
tuples of `Network`. The elements of an array take consecutive indices.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from rvmon.diagnostics import Diagnostic, Span
from rvmon.models import model_error
from rvmon.models.network import expressions as ex
from rvmon.models.network.scope import Names


@dataclass(frozen=True, slots=True)
class Clock:
    """A clock. All clocks start at 0 and run at the rate of time unless a location sets another."""

    name: str


@dataclass(frozen=True, slots=True)
class Channel:
    """A channel: a sender meets one receiver, or every possible receiver if it is `broadcast`.

    Time does not pass while an `urgent` channel can be used.
    """

    name: str
    broadcast: bool = False
    urgent: bool = False


@dataclass(frozen=True, slots=True)
class Sync:
    """One end of a channel, as an edge uses it."""

    slot: ex.Slot
    sends: bool


@dataclass(frozen=True, slots=True)
class Guard:
    """A condition on the variables, joined by "and" with comparisons of clocks."""

    data: ex.Expression = ex.TRUE
    clocks: tuple[ex.ClockCompare, ...] = ()


@dataclass(frozen=True, slots=True)
class Rate:
    """The rate of a clock: its increase per unit of time."""

    clock: int
    value: ex.Expression


@dataclass(frozen=True, slots=True)
class Location:
    """A location. Its invariant bounds clocks from above only."""

    name: str
    kind: ex.LocationKind
    invariant: Guard
    span: Span | None = field(default=None, compare=False)
    rates: tuple[Rate, ...] = ()  # clock rates while the automaton is here; others run at 1
    # The rate per unit of time, as a numerator and a denominator, at which a random run leaves a
    # location in which it may stay forever; `None`: the default of `statistics`.
    leaving: tuple[ex.Expression, ex.Expression] | None = None


@dataclass(frozen=True, slots=True)
class Edge:
    """An edge between two locations of one automaton."""

    source: int
    target: int
    guard: Guard
    sync: Sync | None
    updates: tuple[ex.Statement, ...]  # in order of execution
    weight: float  # share of the runs that take this edge where they can, in (0, 1]
    label: str  # the action's name in recordings; empty: the channel's name, if it has one
    text: str  # the edge for people
    span: Span | None = field(default=None, compare=False)
    # Whether a watcher takes this edge along with a move of the other automata. The guard then
    # reads the locations and variables as the move leaves them.
    watches: bool = False


@dataclass(frozen=True, slots=True)
class Automaton:
    """One process of the network."""

    name: str
    locations: tuple[Location, ...]
    edges: tuple[Edge, ...]
    initial: int
    span: Span | None = field(default=None, compare=False)

    def leaving(self) -> list[list[int]]:
        """For each location, the indices of the edges that leave it."""
        numbers: list[list[int]] = [[] for _ in self.locations]
        for number, edge in enumerate(self.edges):
            numbers[edge.source].append(number)
        return numbers


@dataclass(frozen=True, slots=True)
class Priorities:
    """Ranks of steps: a step is held back while a step of higher rank is possible."""

    # A number for each automaton. The highest number of the automata that take part counts.
    automata: tuple[int, ...]
    internal: int  # the number for steps without a channel
    # A number for each channel. These are multiples of a number above all those of automata, so
    # that channels decide first.
    channels: tuple[int, ...]

    def rank(self, channel: int | None, automata: Iterable[int]) -> int:
        """The rank of a step: its channel (`None`: internal) decides, then its automata."""
        level = self.internal if channel is None else self.channels[channel]
        return level + max(self.automata[one] for one in automata)


@dataclass(frozen=True, slots=True)
class LeadsToFormula:
    """Wherever `left` holds, every run reaches `right`, within `bound` if there is one."""

    left: ex.Expression
    right: ex.Expression
    bound: int | None = None


@dataclass(frozen=True, slots=True)
class Chance:
    """The share of random runs that reach a condition, or keep it (`A[]`), within a horizon."""

    op: ex.PathOp
    body: ex.Expression
    horizon: int
    runs: int | None  # the number of runs; `None`: the default, or as many as a test needs
    # A test asks whether the share is `>=` or `<=` the level. An estimate has `None`.
    sign: ex.BinaryOp | None
    level: float


@dataclass(frozen=True, slots=True)
class Mean:
    """The average, over random runs, of the largest or least value within a horizon."""

    largest: bool
    value: ex.Expression
    horizon: int
    runs: int | None


@dataclass(frozen=True, slots=True)
class Term:
    """A quantity with a value in each state: a clock, or an expression if `clock` is `None`."""

    text: str
    value: ex.Expression
    clock: int | None = None


@dataclass(frozen=True, slots=True)
class Simulation:
    """Random runs to show: the values of some terms over time, up to a horizon."""

    terms: tuple[Term, ...]
    horizon: int
    runs: int


@dataclass(frozen=True, slots=True)
class Extremes:
    """The largest, or least, values of some terms over all reachable states."""

    ends: tuple[bool, ...]  # `True` for the largest values, `False` for the least
    where: ex.Expression  # only states in which this holds are considered
    terms: tuple[Term, ...]


ValueQuery = Chance | Mean | Simulation | Extremes
"""Queries answered by numbers or values instead of yes or no."""

QueryFormula = ex.Expression | LeadsToFormula | ValueQuery


@dataclass(frozen=True, slots=True)
class Query:
    """A question to the model checker."""

    id: str
    remark: str
    text: str
    formula: QueryFormula
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Signal:
    """A name that specifications may use, and its value in the network."""

    name: str
    value: ex.Expression


@dataclass(frozen=True, slots=True)
class Network:
    """Automata that run in parallel."""

    name: str
    title: str
    unit: int | None  # ticks of one unit of time; `None` if the model names none
    clocks: tuple[Clock, ...]
    variables: tuple[ex.Variable, ...]
    channels: tuple[Channel, ...]
    automata: tuple[Automaton, ...]
    queries: tuple[Query, ...]
    # the names for specifications, with their expressions over locations and variables
    signals: tuple[Signal, ...]
    warnings: tuple[Diagnostic, ...] = field(compare=False)
    names: Names = field(compare=False, repr=False)  # the names that queries may use
    priorities: Priorities | None = None  # `None` if all steps are equal
    # whether some edges were split, for differences of clocks or clocks under `or`
    has_split_edges: bool = field(default=False, compare=False)
    # the place of a number with a fraction, if there is one: such models are only simulated
    fraction: Span | None = field(default=None, compare=False)
    # The network that this one extends, or `None`. Runs are shown in terms of the original, without
    # the automata, clocks and variables appended to it.
    original: Network | None = None
    # Whether the last automaton watches the others: it takes part in each of their moves, and a
    # move in which it cannot take part is impossible.
    is_watched: bool = False

    @property
    def rates(self) -> Iterator[tuple[Location, Rate]]:
        """All clock rates other than 1, with their locations."""
        return (
            (place, rate)
            for automaton in self.automata
            for place in automaton.locations
            for rate in place.rates
            if rate.value != ex.Constant(1)
        )

    @property
    def locals(self) -> tuple[ex.Variable, ...]:
        """Parameters and local variables of functions; the last one has slot −1."""
        return tuple(reversed(self.names.functions.locals))


def check_clocks(network: Network, of_query: Iterable[int] = ()) -> None:
    """Refuse queries whose answer depends on fractions or on clocks with rates other than 1."""
    refuse_fraction(network.fraction)
    if next(network.rates, None) is None:
        return
    guards = [
        *(place.invariant for a in network.automata for place in a.locations),
        *(edge.guard for a in network.automata for edge in a.edges),
    ]
    compared = {clock.clock for guard in guards for clock in guard.clocks} | set(of_query)
    found = [(p, r) for p, r in network.rates if r.clock in compared or network.has_split_edges]
    if found:
        place, rate = found[0]
        message = (
            f"`{network.clocks[rate.clock].name}` stops or changes its rate and is compared "
            f"({len(found)} places): what such clocks can reach is not decidable"
        )
        raise model_error("TA016", message, place.span, _SIMULATE)


_SIMULATE = "ask for figures, which are simulated: Pr[<=T](<> p), E[<=T; n](max: e)"


def refuse_fraction(place: Span | None) -> None:
    """Refuse to prove anything if the model has a number with a fraction at `place`."""
    if place is not None:
        message = "a number with a fraction: proofs work on integers only"
        raise model_error("TA016", message, place, _SIMULATE)
