"""Probabilities and expected values estimated from random runs, with error bounds.

A probability is estimated with Clopper-Pearson bounds, or compared with a level by Wald's
sequential test, which takes as many runs as it needs. An expected value has bounds by the normal
approximation. `simulate` describes how runs are drawn.

Source: Wald, Sequential Tests of Statistical Hypotheses, 1945; Younes and Simmons, Statistical
Probabilistic Model Checking, 2006 (the indifference region).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import fsum, log, log1p, sqrt
from random import Random
from statistics import NormalDist
from typing import TypeVar

from rvmon.confidence import interval
from rvmon.models import model_error
from rvmon.models.network import Chance, Mean, Network, Query, Simulation
from rvmon.models.network.evaluate import evaluator
from rvmon.models.network.expressions import BinaryOp, PathOp
from rvmon.models.network.fractions import GRID, number_in
from rvmon.models.network.guards import has_deadlock, has_paths, normal_form
from rvmon.models.runs.moves import Space, State, check_start
from rvmon.models.runs.simulate import CutShortError, stretches, trial_of

RUNS = 1_000  # the default number of runs of an estimate

MARGIN = 0.01
"""A test may be wrong if the probability is nearer than this to the level. Near 0 and 1 the margin
is at most half the distance from the level to the end."""

ERROR = 0.05  # the probability of a wrong test, either way; estimates have confidence 1 − ERROR
MOST_TRIALS = 1_000_000  # a test stops undecided after so many runs
MEAN_WAIT = 10.0  # mean of the exponential part of waits without end, in units of time

Drawn = TypeVar("Drawn")


@dataclass(frozen=True, slots=True)
class Sampled:
    """The result of a query, from random runs.

    Attributes:
        query: the query.
        runs: the number of runs simulated.
        value: the share of runs, or the mean.
        low, high: the 95 % confidence bounds of an estimate; `None` for a test.
        holds: the result of a test; `None` for an estimate or if the test stopped undecided.
        margin: the margin of a test, which may be wrong if the probability is nearer to the level.
    """

    query: Query
    runs: int
    value: float
    low: float | None = None
    high: float | None = None
    holds: bool | None = None
    margin: float | None = None


@dataclass(frozen=True, slots=True)
class Trajectory:
    """One random run: instants in units of time, and the values of all terms at each of them."""

    times: tuple[Fraction, ...]
    values: tuple[tuple[Fraction, ...], ...]


def trajectories(
    network: Network, query: Query, *, seed: int = 1, watch: Callable[[int], bool] | None = None
) -> list[Trajectory]:
    """Answer `simulate`: the values at both ends of each stretch between two moves.

    Args:
        network: the network to simulate.
        query: `simulate [<=T; n] {e, …}`.
        seed: of all random choices.
        watch: called from time to time with the number of runs; whether to continue.

    Raises:
        ModelError: the query is no simulation, or the network cannot start.
    """
    random, runs = _random(network, query, seed), _Runs(watch)
    formula = query.formula
    if not isinstance(formula, Simulation):
        raise model_error("TA020", "this query does not simulate runs", query.span)
    space = Space(network, GRID)
    read = [None if term.clock is not None else evaluator(term.value) for term in formula.terms]

    def values(state: State, clocks: Sequence[float]) -> tuple[Fraction, ...]:
        return tuple(
            Fraction(clocks[(term.clock or 0) + 1]) / GRID
            if value is None
            else Fraction(number_in(term.value, value(state.locations, state.values)))
            for term, value in zip(formula.terms, read, strict=True)
        )

    def one() -> Trajectory:
        now, points = 0, dict[tuple[int, tuple[Fraction, ...]], None]()
        horizon, wait = formula.horizon * GRID, MEAN_WAIT * GRID
        for state, clocks, rates, stay in stretches(space, horizon, random, wait, runs.continues):
            points[now, values(state, clocks)] = None
            now += stay
            later = [clock + stay * rate for clock, rate in zip(clocks, rates, strict=True)]
            points[now, values(state, later)] = None
        instants, rows = zip(*points, strict=True)
        return Trajectory(tuple(Fraction(t, GRID) for t in instants), rows)

    return list(runs.drawn(one, formula.runs))


def _random(network: Network, query: Query, seed: int) -> Random:
    """The source of all random choices; refuses networks whose probabilities are undefined."""
    check_start(network)
    if network.has_split_edges:
        fix = "compare clocks with numbers, without `or`; or ask whether it can happen: E<> p"
        where = "clocks under `or`, or their differences, split edges"
        raise model_error("TA020", f"probabilities are undefined where {where}", query.span, fix)
    return Random(seed)  # noqa: S311 - repeatable, not secret


def sample(
    network: Network, query: Query, *, seed: int = 1, watch: Callable[[int], bool] | None = None
) -> Sampled:
    """Answer a query about probabilities or expected values by simulation.

    Args:
        network: the network to simulate.
        query: `Pr…` or `E[…](max: …)`.
        seed: of all random choices.
        watch: called from time to time with the number of runs; whether to continue.

    Raises:
        ModelError: the query cannot be judged from single runs, or the network cannot start.
    """
    random = _random(network, query, seed)
    runs = _Runs(watch)
    match query.formula:
        case Chance() as chance:
            return _chance(network, query, chance, random, runs)
        case Mean() as mean:
            return _mean(network, query, mean, random, runs)
        case _:
            raise model_error("TA020", "this query asks for no probability or mean", query.span)


class _Runs:
    """Random runs, as long as the caller lets them continue."""

    def __init__(self, watch: Callable[[int], bool] | None) -> None:
        self._watch = watch
        self._count = 0

    def continues(self) -> bool:
        """Whether to continue, with another run or within one."""
        return self._watch is None or self._watch(self._count)

    def drawn(self, draw: Callable[[], Drawn], most: int) -> Iterator[Drawn]:
        """The results of at most `most` runs."""
        while self._count < most and self.continues():
            try:
                yield draw()
            except CutShortError:
                return
            self._count += 1


def _chance(network: Network, query: Query, chance: Chance, random: Random, runs: _Runs) -> Sampled:
    if has_deadlock(chance.body):
        reason = "a deadlock is a lack of moves, and random runs are checked by their states alone"
        fix = "ask whether one is reachable: E<> deadlock"
        raise model_error("TA020", reason, query.span, fix)
    if has_paths(chance.body):
        reason = "a random run is evaluated alone, and this formula refers to other runs"
        fix = "write a condition on the state: Pr[<=T](<> p)"
        raise model_error("TA020", reason, query.span, fix)
    meets = chance.op is PathOp.FINALLY
    sought = normal_form(chance.body, positive=meets)
    trial = trial_of(network, sought, chance.horizon, random, MEAN_WAIT, runs.continues)
    if chance.sign is not None:
        return _tested(query, chance, lambda: trial() == meets, runs)
    met = [found == meets for found in runs.drawn(trial, chance.runs or RUNS)]
    low, high = interval(sum(met), len(met), 1 - ERROR) if met else (0.0, 1.0)
    return Sampled(query, len(met), sum(met) / max(1, len(met)), low, high)


def _tested(query: Query, chance: Chance, trial: Callable[[], bool], runs: _Runs) -> Sampled:
    """Wald's sequential test of `level + margin` against `level - margin`."""
    level = chance.level
    margin = min(MARGIN, level / 2, (1 - level) / 2)
    above, below = level + margin, level - margin
    # The evidence is the log-likelihood ratio of `below` to `above`.
    hit, miss = log(below) - log(above), log1p(-below) - log1p(-above)
    limit = log((1 - ERROR) / ERROR)
    evidence, met = 0.0, list[bool]()
    for one in runs.drawn(trial, chance.runs or MOST_TRIALS):
        met.append(one)
        evidence += hit if one else miss
        if not -limit < evidence < limit:
            break
    share = sum(met) / max(1, len(met))
    if -limit < evidence < limit:
        return Sampled(query, len(met), share, margin=margin)
    holds = (evidence < 0) == (chance.sign is BinaryOp.GE)
    return Sampled(query, len(met), share, holds=holds, margin=margin)


def _mean(network: Network, query: Query, mean: Mean, random: Random, runs: _Runs) -> Sampled:
    space, value = Space(network, GRID), evaluator(mean.value)
    best: Callable[[list[float]], float] = max if mean.largest else min

    def reached() -> float:
        run = stretches(space, mean.horizon * GRID, random, MEAN_WAIT * GRID, runs.continues)
        return best([number_in(mean.value, value(s.locations, s.values)) for s, *_ in run])

    found = list(runs.drawn(reached, mean.runs or RUNS))
    if len(found) < 2:
        raise model_error("TA019", "too few runs were simulated", query.span)
    middle = fsum(found) / len(found)
    spread = sqrt(fsum((one - middle) ** 2 for one in found) / (len(found) - 1))
    away = NormalDist().inv_cdf(1 - ERROR / 2) * spread / sqrt(len(found))
    return Sampled(query, len(found), middle, middle - away, middle + away)
