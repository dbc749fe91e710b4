"""Random runs of a network, and shares of them with confidence bounds: figures, not proofs.

How chance decides: each automaton draws one of the moves that it begins and that are possible now
or after a delay, in proportion to their weights, and a delay for it: uniformly from the window in
which it is possible, or, if that has no end, from an exponential distribution behind its beginning.
Weights that add up to less than 1 leave the rest to doing nothing this time. The automaton with the
shortest delay moves, and all draw anew.

Source: David, Larsen, Legay, Mikučionis, Wang, Time for Statistical Model Checking of Real-Time
Systems, CAV 2011 (races between components; weights among the moves of one).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import ceil, exp, fsum, inf, lgamma, log, log1p, prod
from random import Random

from rvmon.timed.model.expressions import Expression, PathFormula
from rvmon.timed.model.guards import normal_form
from rvmon.timed.model.network import Network, Query
from rvmon.timed.model.operators import PathOp
from rvmon.timed.model.rules import model_error
from rvmon.timed.zones.deadlock import check_start
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.successors import Space
from rvmon.timed.zones.zone_unions import (
    Constraint,
    ConstraintMaker,
    constraint_maker,
    formula_bounds,
    has_paths,
    speaks_of_deadlock,
)

GRID = 1_000
"""Steps of simulated time in one unit: all times are whole numbers of them."""

MOST_MOVES = 100_000
"""A run with more moves before its end is taken for a Zeno loop."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A share of simulated runs.

    Attributes:
        runs: how many were simulated.
        successes: how many of them did what the query says.
        low: the share is not below, with the given confidence.
        high: nor above.
        confidence: such as 0.95.
    """

    runs: int
    successes: int
    low: float
    high: float
    confidence: float

    @property
    def share(self) -> float:
        """Successes among the runs."""
        return self.successes / self.runs


def estimate(
    network: Network,
    query: Query,
    *,
    runs: int,
    seed: int,
    until: int | None = None,
    mean_wait: float = 10.0,
    confidence: float = 0.95,
) -> Estimate:
    """Simulate runs and count those that do what a query says.

    Args:
        network: what to simulate.
        query: `E<> p` or `A<> p`: the share of runs that meet p; `A[] p` or `E[] p`: of those that
            never leave it; within the query's bound, or `until`.
        runs: how many, at least 1.
        seed: of all choices.
        until: units of time that a run lasts, if the query has no bound.
        mean_wait: units of time by which a wait without end exceeds its beginning on average.
        confidence: that the true share lies within the bounds, over all seeds.

    Raises:
        ModelError: the query cannot be judged on one run, or the network cannot start.

    Source: Clopper and Pearson, The Use of Confidence or Fiducial Limits, 1934.
    """
    check_start(network)
    sought, meets, horizon = _goal(query, until)
    trial = trial_of(network, sought, horizon, Random(seed), mean_wait)  # noqa: S311 - repeatable
    found = sum(trial() for _ in range(runs))
    successes = found if meets else runs - found
    low, high = exact_bounds(successes, runs, confidence)
    return Estimate(runs, successes, low, high, confidence)


def trial_of(
    network: Network, sought: Expression, horizon: int, random: Random, mean_wait: float
) -> Callable[[], bool]:
    """What simulates one run and says whether it meets a normalised formula within a horizon."""
    space = Space(network, formula_bounds(sought, network))
    constraints = constraint_maker(sought)
    return lambda: _reaches(space, constraints, horizon * GRID, random, mean_wait * GRID)


def _goal(query: Query, until: int | None) -> tuple[Expression, bool, int]:
    """What a run must reach, whether that is a success, and within how many units."""
    formula = query.formula
    if not isinstance(formula, PathFormula) or has_paths(formula.body):
        fix = "use E<>, A<>, A[] or E[] with a state formula"
        raise model_error("TA020", "this cannot be evaluated on one run", query.span, fix)
    if speaks_of_deadlock(formula.body):
        raise model_error("TA020", "a simulated run does not know deadlocks", query.span)
    horizon = until if formula.bound is None else formula.bound
    if horizon is None:
        fix = "bound it, as in E<>[<=100] p, or give the length of a run"
        raise model_error("TA020", "a simulated run needs an end", query.span, fix)
    meets = formula.op in (PathOp.POSSIBLY, PathOp.EVENTUALLY)
    return normal_form(formula.body, positive=meets), meets, horizon


def _reaches(
    space: Space, constraints: ConstraintMaker, horizon: int, random: Random, mean_wait: float
) -> bool:
    """Whether one random run meets a formula within some grid steps."""
    for state, clocks, stay in stretches(space, horizon, random, mean_wait):
        here = constraints(state.vector.locations, state.values)
        if any(_window(constraint, clocks, 0, stay) is not None for constraint in here):
            return True
    return False


def stretches(
    space: Space, horizon: int, random: Random, mean_wait: float
) -> Iterator[tuple[State, list[int], int]]:
    """One random run: each state, the clocks as it begins and how long it lasts, in grid steps."""
    state = space.initial()
    assert state is not None  # noqa: S101 - the network can start
    clocks, now = [0] * space.dim, 0
    for _ in range(MOST_MOVES):
        drawn = _draw(space, state, clocks, random, mean_wait)
        # If nothing is left to do, time passes as long as it may.
        most = _longest(state, clocks) if drawn is None else drawn[1]
        stay = int(min(most, horizon - now))
        yield state, clocks, stay
        if drawn is None or most > stay:
            return
        now += stay
        move = drawn[0]
        clocks = [0, *(clock + stay for clock in clocks[1:])]
        for clock, value in move.resets:
            clocks[clock] = int(value) * GRID
        state = move.target
    fix = "look for a loop in which no time passes: A<> of its end finds one"
    message = f"a simulated run made {MOST_MOVES:,} moves in {now / GRID:g} units of time"
    raise model_error("TA019", message, None, fix)


def _draw(
    space: Space, state: State, clocks: list[int], random: Random, mean_wait: float
) -> tuple[Move, int] | None:
    """A move and its delay in grid steps; `None` if none is possible any more."""
    longest = _longest(state, clocks)
    begun: dict[int, list[tuple[Move, tuple[int, float]]]] = {}
    for move in space.moves(state):
        window = _move_window(move, clocks, longest)
        if window is not None:
            begun.setdefault(move.edges[0].automaton, []).append((move, window))
    draws: list[tuple[int, float, Move]] = []
    while begun and not draws:
        for possible in begun.values():
            weights = [prod(edge.edge.weight for edge in move.edges) for move, _ in possible]
            if random.random() < sum(weights):
                ((move, window),) = random.choices(possible, weights)
                draws.append((_delay(window, random, mean_wait), random.random(), move))
    if not draws:
        return None
    delay, _, move = min(draws, key=lambda draw: draw[:2])
    if move.failure is not None:
        raise move.failure
    return move, delay


def _delay(window: tuple[int, float], random: Random, mean_wait: float) -> int:
    low, high = window
    if high == inf:
        return low + int(random.expovariate(1 / mean_wait))
    return random.randint(low, int(high))


def _longest(state: State, clocks: list[int]) -> float:
    """How long time may pass in a state."""
    if not state.delays:
        return 0
    return min((_limit(bound) - clocks[clock] for clock, bound in state.invariant), default=inf)


def _move_window(move: Move, clocks: list[int], longest: float) -> tuple[int, float] | None:
    """The delays after which a move is possible."""
    set_now = dict(move.resets)
    for clock, bound in move.target.invariant:
        if clock in set_now:
            if set_now[clock] > bound:
                return None
        else:
            longest = min(longest, _limit(bound) - clocks[clock])
    return _window(move.guard, clocks, 0, longest)


def _window(
    atoms: Constraint, clocks: list[int], low: int, high: float
) -> tuple[int, float] | None:
    """The delays in [low, high] after which all bounds hold; `None` if there are none."""
    for x, y, bound in atoms:
        if x == 0:
            high = min(high, _limit(bound) - clocks[y])
        else:
            low = max(low, -_limit(bound) - clocks[x])
    return (low, high) if low <= high else None


def _limit(bound: float) -> int:
    """A bound in grid steps; a strict one is one step less."""
    whole = ceil(bound)
    return whole * GRID - (bound != whole)


def exact_bounds(successes: int, runs: int, confidence: float) -> tuple[float, float]:
    """Bounds of a share that hold with at least the given confidence.

    >>> low, high = exact_bounds(8, 10, 0.95)
    >>> round(low, 4), round(high, 4)
    (0.4439, 0.9748)
    """
    tail = (1 - confidence) / 2
    low = _share_with_tail(successes, runs, tail) if successes > 0 else 0.0
    high = _share_with_tail(successes + 1, runs, 1 - tail) if successes < runs else 1.0
    return low, high


def _share_with_tail(least: int, runs: int, tail: float) -> float:
    """The share for which at least so many successes have the given probability."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        if _probability_of_at_least(least, runs, middle) < tail:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def _probability_of_at_least(least: int, runs: int, share: float) -> float:
    choices = lgamma(runs + 1)
    return fsum(
        exp(
            choices - lgamma(k + 1) - lgamma(runs - k + 1)
            + k * log(share) + (runs - k) * log1p(-share)
        )
        for k in range(least, runs + 1)
    )  # fmt: skip
