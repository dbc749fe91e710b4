"""Random runs of a network.

Each automaton draws one of the moves that it initiates and that are possible now or after a delay,
with probabilities in proportion to their weights. If the weights sum to less than 1, the rest is
the probability of skipping this draw. Then the automaton draws a delay: uniformly from the window
in which the move is possible or, if the window has no end, from an exponential distribution that
starts with the window, at the rate of the location that is left (`rate`, UPPAAL's exponential
rates) if it has one. A move may have several windows, for instance around those of a move of higher
priority; then the delay is drawn from all of them. The automaton with the shortest delay moves, and
all automata draw anew.

Clocks run at the rates that invariants give them. Times are whole grid steps, so that whole rates
are exact. With other rates a clock reaches a bound at the first step at or beyond it.

Source: David, Larsen, Legay, Mikučionis, Wang, Time for Statistical Model Checking of Real-Time
Systems, CAV 2011 (races between components; weights among the moves of one).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import ceil, inf, prod
from random import Random

from rvmon.models import model_error
from rvmon.models.network import Location, Network
from rvmon.models.network.evaluate import evaluator
from rvmon.models.network.expressions import Expression
from rvmon.models.network.fractions import GRID, number_in
from rvmon.models.runs import Atom
from rvmon.models.runs.moves import Move, Space, State, pieces_of

CHECK_EVERY = 256  # moves between two checks whether to continue
SLACK = 1e-6  # steps by which a clock may miss a bound, since rates with a fraction are rounded
MOST_MOVES = 100_000  # a run with more moves before its end is considered a Zeno loop


class CutShortError(Exception):
    """A run was not simulated to its end because the time limit was reached."""


def trial_of(
    network: Network,
    sought: Expression,
    horizon: int,
    random: Random,
    mean_wait: float,
    continues: Callable[[], bool],
) -> Callable[[], bool]:
    """Make a function that simulates a run: whether it meets a formula within the horizon."""
    space = Space(network, GRID)
    pieces = pieces_of(sought, GRID)

    def meets() -> bool:
        run = stretches(space, horizon * GRID, random, mean_wait * GRID, continues)
        return any(
            _window(piece, clocks, rates, 0, stay) is not None
            for state, clocks, rates, stay in run
            for piece in pieces(state.locations, state.values)
        )

    return meets


def stretches(
    space: Space, horizon: int, random: Random, mean_wait: float, continues: Callable[[], bool]
) -> Iterator[tuple[State, list[float], Sequence[float], int]]:
    """Simulate one run: each state, the clocks when it starts, their rates and its duration.

    Clocks and times are in grid steps.

    Raises:
        CutShortError: `continues` stopped the run.
    """
    state, paces = space.initial(), _Paces(space.network)
    assert state is not None, "the network can start"
    clocks: list[float] = [0] * (1 + len(space.network.clocks))
    now = 0
    for number in range(1, MOST_MOVES + 1):
        if number % CHECK_EVERY == 0 and not continues():
            raise CutShortError
        rates = paces.rates(state)
        drawn = _draw(space, state, clocks, rates, random, paces.waits(state, mean_wait))
        # If no move is possible any more, time passes as far as the invariants allow.
        most = _longest(state, clocks, rates) if drawn is None else drawn[1]
        stay = int(min(most, horizon - now))
        yield state, clocks, rates, stay
        if drawn is None or most > stay:
            return
        now += stay
        move = drawn[0]
        clocks = [clock + stay * rate for clock, rate in zip(clocks, rates, strict=True)]
        # Rounding with fractional rates may take a clock slightly beyond its invariant.
        for clock, bound in state.invariant:
            clocks[clock] = min(clocks[clock], _limit(bound))
        for clock, value in move.resets:
            clocks[clock] = round(value)
        state = move.target
    fix = "look for a loop in which no time passes: A<> of its end finds one"
    message = f"a simulated run made {MOST_MOVES:,} moves in {now / GRID:g} units of time"
    raise model_error("TA019", message, None, fix)


def _draw(
    space: Space,
    state: State,
    clocks: list[float],
    rates: Sequence[float],
    random: Random,
    mean_waits: Sequence[float],
) -> tuple[Move, int] | None:
    """Draw a move and its delay in grid steps; `None` if no move is possible any more."""
    longest = _longest(state, clocks, rates)
    by_automaton: dict[int, list[_Choice]] = {}
    for choice in _possible(space, state, clocks, rates, longest):
        by_automaton.setdefault(choice.move.edges[0].automaton, []).append(choice)
    draws: list[tuple[int, float, Move]] = []
    while by_automaton and not draws:
        for automaton, possible in by_automaton.items():
            weights = [prod(edge.edge.weight for edge in choice.move.edges) for choice in possible]
            if random.random() < sum(weights):
                (one,) = random.choices(possible, weights)
                # The random number breaks ties between equal delays without bias.
                draws.append((one.delay(random, mean_waits[automaton]), random.random(), one.move))
    if not draws:
        return None
    delay, _, move = min(draws, key=lambda draw: draw[:2])
    if move.failure is not None:
        raise move.failure
    return move, delay


class _Paces:
    """The rates of clocks in each state, and the mean of waits without end."""

    def __init__(self, network: Network) -> None:
        self._network = network
        self._ones = (1,) * (1 + len(network.clocks))
        self._are_changed = next(network.rates, None) is not None
        self._known: dict[int, tuple[State, tuple[float, ...]]] = {}

    def _places(self, state: State) -> Iterator[Location]:
        for automaton, place in zip(self._network.automata, state.locations, strict=True):
            yield automaton.locations[place]

    def rates(self, state: State) -> tuple[float, ...]:
        """The rate of each clock. Clocks count from 1; entry 0 is unused."""
        if not self._are_changed:
            return self._ones
        if id(state) not in self._known:
            self._known[id(state)] = (state, self._computed(state))
        return self._known[id(state)][1]

    def _computed(self, state: State) -> tuple[float, ...]:
        found: dict[int, float] = {}
        for place in self._places(state):
            for rate in place.rates:
                bits = evaluator(rate.value)(state.locations, state.values)
                value = number_in(rate.value, bits)
                name = self._network.clocks[rate.clock].name
                if found.setdefault(rate.clock + 1, value) != value:
                    message = f"the rate of `{name}` is set by two automata at once"
                    raise model_error("TA007", message, place.span, "give it one")
        return tuple(found.get(clock, 1) for clock in range(len(self._ones)))

    def waits(self, state: State, default: float) -> list[float]:
        """The mean of each automaton's waits without end, in grid steps."""
        return [
            default if place.leaving is None else self._wait(place, place.leaving, state)
            for place in self._places(state)
        ]

    def _wait(self, place: Location, leaving: tuple[Expression, Expression], state: State) -> float:
        often, units = (evaluator(one)(state.locations, state.values) for one in leaving)
        if often <= 0 or units <= 0:
            message = f"`{place.name}` is left at a rate that is not above 0"
            raise model_error("TA017", message, place.span, "write one above 0, such as 1:20")
        return GRID * units / often


def _possible(
    space: Space, state: State, clocks: list[float], rates: Sequence[float], longest: float
) -> list[_Choice]:
    """The moves that are possible now or after a delay, with their windows of delays."""
    found = []
    for move in space.moves(state):
        window = _move_window(move, clocks, rates, longest)
        choice = _Choice(move, [] if window is None else [window])
        for atoms in move.left_out:
            taken = _window(atoms, clocks, rates, 0, longest)
            if taken is not None:
                choice.take_out(taken)
        found.append(choice)
    if space.network.priorities is not None:
        whole = [(choice.move.rank, choice.windows) for choice in found]
        for one in found:
            one.windows = [*one.windows]
            for window in (w for rank, windows in whole if rank > one.move.rank for w in windows):
                one.take_out(window)
    return [choice for choice in found if choice.windows]


@dataclass(slots=True)
class _Choice:
    """A move with the windows of delays after which it is possible, in ascending order."""

    move: Move
    windows: list[tuple[int, float]]

    def take_out(self, window: tuple[int, float]) -> None:
        """Remove the delays in a window."""
        first, last = window
        rest: list[tuple[int, float]] = []
        for low, high in self.windows:
            rest.append((low, min(high, first - 1)))
            if last < inf:
                rest.append((max(low, int(last) + 1), high))
        self.windows = [(low, high) for low, high in rest if low <= high]

    def delay(self, random: Random, mean_wait: float) -> int:
        """Draw a delay: uniformly from all windows, or exponentially if the last has no end."""
        counts = [b - a + 1 for a, b in self.windows]
        if counts[-1] == inf:
            drawn = int(random.expovariate(1 / mean_wait))
        else:
            drawn = random.randrange(int(sum(counts)))
        place = 0
        while drawn >= counts[place]:
            drawn -= int(counts[place])
            place += 1
        return self.windows[place][0] + drawn


def _longest(state: State, clocks: list[float], rates: Sequence[float]) -> float:
    """The longest delay that the invariants of a state allow."""
    if not state.delays:
        return 0
    atoms = tuple((0, clock, bound) for clock, bound in state.invariant)
    window = _window(atoms, clocks, rates, 0, inf)
    return 0 if window is None else window[1]


def _move_window(
    move: Move, clocks: list[float], rates: Sequence[float], longest: float
) -> tuple[int, float] | None:
    """The delays after which a move is possible; `None` if there are none."""
    set_now, atoms = dict(move.resets), list(move.guard)
    for clock, bound in move.target.invariant:
        if clock not in set_now:
            atoms.append((0, clock, bound))
        elif set_now[clock] > bound:
            return None
    return _window(tuple(atoms), clocks, rates, 0, longest)


def _window(
    atoms: Sequence[Atom], clocks: list[float], rates: Sequence[float], low: int, high: float
) -> tuple[int, float] | None:
    """The delays in [low, high] after which all bounds hold; `None` if there are none."""
    for x, y, bound in atoms:
        sign, clock = (1, y) if x == 0 else (-1, x)
        # The bound says: sign * clock <= limit.
        left, rate = _limit(bound) - sign * clocks[clock], sign * rates[clock]
        if rate == 0:
            if left < -SLACK:
                return None
            continue
        if isinstance(left, int) and isinstance(rate, int):
            step = left // rate if rate > 0 else -(left // -rate)
        else:
            step = ceil(left / rate - SLACK)
        low, high = (low, min(high, step)) if rate > 0 else (max(low, step), high)
    return (low, high) if low <= high else None


def _limit(bound: float) -> int:
    """A bound in grid steps; a strict bound is one step less."""
    whole = ceil(bound)
    return whole - (bound != whole)
