"""A network of timed automata with all names resolved: what every algorithm here starts from.

Clocks, variables, channels, automata, locations and edges are referred to by their index in the
tuples of `Network`. Arrays are spread over neighbouring indices.
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
    """A clock; all start at 0 and run at the rate of time."""

    name: str


@dataclass(frozen=True, slots=True)
class Channel:
    """A channel: a sender meets one receiver, or all that can receive if `broadcast`.

    Time does not pass while an `urgent` one can be used.
    """

    name: str
    broadcast: bool = False
    urgent: bool = False


@dataclass(frozen=True, slots=True)
class Sync:
    """One end of a channel."""

    slot: ex.Slot
    sends: bool


@dataclass(frozen=True, slots=True)
class Guard:
    """A condition: on the variables and, all together, on clocks."""

    data: ex.Expression = ex.TRUE
    clocks: tuple[ex.ClockCompare, ...] = ()


@dataclass(frozen=True, slots=True)
class Rate:
    """The rate of a clock: its increase per unit of time."""

    clock: int
    value: ex.Expression


@dataclass(frozen=True, slots=True)
class Location:
    """A location; its invariant bounds clocks from above only."""

    name: str
    kind: ex.LocationKind
    invariant: Guard
    span: Span | None = field(default=None, compare=False)
    rates: tuple[Rate, ...] = ()  # of clocks, while the automaton is there; others run at 1
    # the rate, per unit of time, at which a random run leaves it if it may stay for ever, as a
    # fraction; `None`: as `statistics` says
    leaving: tuple[ex.Expression, ex.Expression] | None = None


@dataclass(frozen=True, slots=True)
class Edge:
    """An edge between two locations of one automaton."""

    source: int
    target: int
    guard: Guard
    sync: Sync | None
    updates: tuple[ex.Statement, ...]  # in the order in which they happen
    weight: float  # share of the runs that take it where they can, in (0, 1]
    label: str  # the action's name in recordings; empty: the channel's name, if it has one
    text: str  # the edge for people
    span: Span | None = field(default=None, compare=False)
    # whether a watcher takes it along with each move of the others that its guard, which reads what
    # the move made of locations and variables, allows
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
        """For each location the numbers of the edges that leave it."""
        numbers: list[list[int]] = [[] for _ in self.locations]
        for number, edge in enumerate(self.edges):
            numbers[edge.source].append(number)
        return numbers


@dataclass(frozen=True, slots=True)
class Priorities:
    """Which steps keep back which others, where both can be taken: those of lower rank."""

    # a number for each; of the automata that take part the highest counts
    automata: tuple[int, ...]
    internal: int  # the number of steps without a channel
    # a number for each; all these are multiples of what is above those of automata
    channels: tuple[int, ...]

    def rank(self, channel: int | None, automata: Iterable[int]) -> int:
        """The priority of a step: its channel's (`None`: an internal step), then its automata's."""
        level = self.internal if channel is None else self.channels[channel]
        return level + max(self.automata[one] for one in automata)


@dataclass(frozen=True, slots=True)
class LeadsToFormula:
    """Wherever `left` holds, `right` will on every run, within `bound` if there is one."""

    left: ex.Expression
    right: ex.Expression
    bound: int | None = None


@dataclass(frozen=True, slots=True)
class Chance:
    """The share of random runs that meet a condition, or keep it (`A[]`), within a horizon."""

    op: ex.PathOp
    body: ex.Expression
    horizon: int
    runs: int | None  # the number simulated; `None`: as many as the default, or a test takes
    # sign, level: a test: whether the share is `>=` or `<=` that; `None`: an estimate
    sign: ex.BinaryOp | None
    level: float


@dataclass(frozen=True, slots=True)
class Mean:
    """The largest, or least, value that random runs have within a horizon, on average."""

    largest: bool
    value: ex.Expression
    horizon: int
    runs: int | None


@dataclass(frozen=True, slots=True)
class Term:
    """Something that has a value in each state: a clock, or an expression if `clock` is `None`."""

    text: str
    value: ex.Expression
    clock: int | None = None


@dataclass(frozen=True, slots=True)
class Simulation:
    """Random runs as they go on: the values of some terms, up to a horizon."""

    terms: tuple[Term, ...]
    horizon: int
    runs: int


@dataclass(frozen=True, slots=True)
class Extremes:
    """The largest, or least, values of some terms over all reachable states."""

    ends: tuple[bool, ...]  # `True` for the largest values, `False` for the least
    where: ex.Expression  # only states in which this holds count
    terms: tuple[Term, ...]


Asked = Chance | Mean | Simulation | Extremes
"""Queries that are answered by figures or values, not by yes or no."""

QueryFormula = ex.Expression | LeadsToFormula | Asked


@dataclass(frozen=True, slots=True)
class Query:
    """A question to the model checker; `formula` speaks of runs."""

    id: str
    remark: str
    text: str
    formula: QueryFormula
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Signal:
    """A name of specifications for something of the network."""

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
    warnings: tuple[Diagnostic, ...] = field(compare=False)  # about it
    names: Names = field(compare=False, repr=False)  # the names that queries may use
    priorities: Priorities | None = None  # of steps; `None` if all are equal
    # whether some edges were taken apart, for differences of clocks or clocks under `or`
    has_split_edges: bool = field(default=False, compare=False)
    # the place of a number with a fraction, of which nothing is proved, if it has one
    fraction: Span | None = field(default=None, compare=False)
    # the network of which this one says more: its runs are shown without the automata, clocks and
    # variables that stand behind those of that; `None`: it is none such
    original: Network | None = None
    # whether the last automaton watches the others: it takes part in each of their moves, or the
    # move is not possible
    is_watched: bool = False

    @property
    def rates(self) -> Iterator[tuple[Location, Rate]]:
        """All rates of clocks that are not 1, with their locations."""
        return (
            (place, rate)
            for automaton in self.automata
            for place in automaton.locations
            for rate in place.rates
            if rate.value != ex.Constant(1)
        )

    @property
    def locals(self) -> tuple[ex.Variable, ...]:
        """Parameters and local variables of functions; the last stands in slot −1."""
        return tuple(reversed(self.names.functions.locals))


def check_clocks(network: Network, asked: Iterable[int] = ()) -> None:
    """Refuse to decide what depends on fractions, or on clocks that stop or run at other rates."""
    refuse_fraction(network.fraction)
    if next(network.rates, None) is None:
        return
    guards = [
        *(place.invariant for a in network.automata for place in a.locations),
        *(edge.guard for a in network.automata for edge in a.edges),
    ]
    compared = {clock.clock for guard in guards for clock in guard.clocks} | set(asked)
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
    """Refuse to decide anything of a number with a fraction, if there is one."""
    if place is not None:
        message = "a number with a fraction: proofs work on integers only"
        raise model_error("TA016", message, place, _SIMULATE)
