"""Paths of symbolic states as sequences of steps, and the timed runs along them.

The times of the steps along a path satisfy constraints `t[q] − t[p] <= c`, and every solution is a
timed run. A system with integer constants and strict bounds has a solution if and only if it has
one on a grid of 1/scale, where `scale` is larger than the number of steps. So all computations use
integers: a strict bound is one grid step less.

Source: Alur, Kurshan, Viswanathan, Membership Questions for Timed and Hybrid Automata, RTSS 1998
(a path's timed runs as difference constraints).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise, product
from math import ceil, inf, isqrt

from rvmon.models import runs
from rvmon.models.network import Network
from rvmon.models.runs.exact_times import Rules
from rvmon.models.runs.moves import Move, State


@dataclass(frozen=True, slots=True)
class TimedStep:
    """The timed part of a step."""

    waits: bool  # whether time may pass before it
    leave: tuple[runs.Atom, ...]  # bounds that hold at its instant, before it
    resets: tuple[tuple[int, float], ...]  # the clocks that it sets, with their values
    enter: tuple[runs.Atom, ...]  # bounds that hold at its instant, after it


def timing_of(steps: Sequence[TimedStep], start: runs.Zone | None = None) -> runs.Timing | None:
    """The timed runs along a path; `None` if there are none.

    Args:
        steps: the steps of the path.
        start: the valuations from which it may start; `None`: all clocks are 0. If given, the last
            rows and columns of the result stand for the instants at which each clock was 0.
    """
    dim = 1 if start is None else isqrt(len(start))
    size = len(steps) + dim
    # Each strict bound on the path is one grid step less. A unit has more steps than the path has
    # bounds, so that no cycle of constraints can lose a whole unit.
    scale = size + 1
    found: list[list[runs.Constraint]] = [[] for _ in range(len(steps) + 1)]
    reset_at: dict[int, tuple[int, float]] = {}
    if start is not None:
        # for each clock, the instant before the start at which it was 0
        born = [0, *range(len(steps) + 1, size)]
        reset_at = {clock: (born[clock], 0.0) for clock in range(1, dim)}
        for x, y in product(range(dim), repeat=2):
            if start[x * dim + y] < inf:
                found[0].append((born[y], born[x], on_grid(start[x * dim + y], scale)))

    def apply(atoms: Iterable[runs.Atom], now: int) -> None:
        for x, y, bound in atoms:
            # The value of a clock is t[now] − t[its reset] + the value it was set to.
            (p, low), (q, high) = reset_at.get(x, (0, 0.0)), reset_at.get(y, (0, 0.0))
            if x == 0:
                found[now].append((q, now, on_grid(bound - high, scale)))
            elif y == 0:
                found[now].append((now, p, on_grid(bound + low, scale)))
            else:
                found[now].append((q, p, on_grid(bound - high + low, scale)))

    for now, step in enumerate(steps, start=1):
        found[now].append((now, now - 1, 0.0))
        if not step.waits:
            found[now].append((now - 1, now, 0.0))
        apply(step.leave, now)
        for clock, value in step.resets:
            reset_at[clock] = now, value
        apply(step.enter, now)
    timing = runs.Timing(found, dim - 1, scale)
    return timing if timing.is_possible else None


def on_grid(bound: float, scale: int) -> float:
    """A finite bound in grid steps; a strict bound is one step less."""
    whole = ceil(bound)
    return whole * scale - (bound != whole)


def windows(timing: runs.Timing) -> list[runs.Window]:
    """The shortest and longest wait before each step, over all runs along the path."""
    found = []
    for low, high, _ in timing.waits:
        least = int(low // timing.scale)
        most = None if high == inf else int(-(-high // timing.scale))
        is_below = most is not None and most * timing.scale != high
        found.append(runs.Window(least, most, least * timing.scale != low, is_below))
    return found


def earliest(timing: runs.Timing) -> list[Fraction]:
    """The delay before each step in the run that does every step as early as possible.

    The earliest times solve all constraints at once, so no choice restricts a later one. A strict
    bound is kept by one grid step.
    """
    times = (0.0, *(first for _, _, first in timing.waits))
    return [Fraction(int(later - before), timing.scale) for before, later in pairwise(times)]


Piece = tuple[runs.Atom, ...]  # bounds that hold together; an empty piece holds everywhere


@dataclass(frozen=True, slots=True)
class PathStep(TimedStep):
    """One instant of a path of a network."""

    move: Move | None  # `None` if the instant only matters for the query
    state: State


def invariant_of(state: State) -> Piece:
    """The invariant of a state as bounds."""
    return tuple((0, clock, bound) for clock, bound in state.invariant)


def move_step(state: State, move: Move, leave: Piece = (), enter: Piece = ()) -> PathStep:
    """A move, with further bounds that must hold before and after it."""
    before = (*invariant_of(state), *move.guard, *leave)
    after = (*invariant_of(move.target), *enter)
    return PathStep(state.delays, before, move.resets, after, move, move.target)


def mark_step(state: State, holds: Piece, resets: Sequence[int] = ()) -> PathStep:
    """An instant at which some bounds hold and some clocks of the query start."""
    started = tuple((clock, 0.0) for clock in resets)
    return PathStep(state.delays, (*invariant_of(state), *holds), started, (), None, state)


def crossing_step(state: State, leave: Piece, enter: Piece) -> PathStep:
    """The instant at which a run passes from one piece of a formula to another."""
    return PathStep(state.delays, (*invariant_of(state), *leave), (), enter, None, state)


def make_run(
    network: Network,
    start: State,
    steps: Sequence[PathStep],
    ending: runs.Ending = runs.Ending.REACHED,
    loop: int | None = None,
) -> runs.Run:
    """The run along a path in which every step happens as early as possible.

    The path may belong to a network that extends this one with further automata, clocks and
    variables; these are left out. `loop` is the index of the first step that is repeated.
    """
    timing = timing_of(steps)
    assert timing is not None, "the search found a run along the path"
    run_steps = tuple(
        runs.RunStep(window, wait, _action(network, step.move), _position(network, step.state))
        for step, window, wait in zip(steps, windows(timing), earliest(timing), strict=True)
    )
    run = runs.Run(_position(network, start), run_steps, ending, loop, timing)
    # Check each run with the plain rules, which share no code with the search.
    Rules(network).replay(run)
    return run


def _action(network: Network, move: Move | None) -> runs.Action | None:
    edges = tuple(
        (edge.automaton, network.automata[edge.automaton].edges[edge.number])
        for edge in (() if move is None else move.edges)
        if edge.automaton < len(network.automata)
    )
    return runs.Action(edges) if edges else None


def _position(network: Network, state: State) -> runs.Position:
    automata, variables = len(network.automata), len(network.variables)
    return runs.Position(state.locations[:automata], state.values[:variables])
