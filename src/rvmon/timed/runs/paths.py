"""Paths of symbolic states step by step, and the runs along them.

A run has the exact window of each wait, and concrete times that the plain rules have checked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.timed.model.network import Network
from rvmon.timed.runs.concrete import Rules
from rvmon.timed.runs.constraints import Atom
from rvmon.timed.runs.run import Action, Ending, Position, Run, RunStep
from rvmon.timed.runs.space import Move, State
from rvmon.timed.runs.timing import TimedStep, earliest, timing_of, windows

Piece = tuple[Atom, ...]
"""Bounds that hold together; without any they hold everywhere."""


@dataclass(frozen=True, slots=True)
class PathStep:
    """One instant of a path.

    Attributes:
        timed: what its time must satisfy.
        move: what is done; `None` if the instant matters for the query only.
        state: where the path is then.
    """

    timed: TimedStep
    move: Move | None
    state: State


def invariant_of(state: State) -> Piece:
    """A state's invariant as bounds."""
    return tuple((0, clock, bound) for clock, bound in state.invariant)


def move_step(state: State, move: Move, leave: Piece = (), enter: Piece = ()) -> PathStep:
    """A move, with what else must hold before and after it."""
    target = move.target
    timed = TimedStep(
        state.delays,
        (*invariant_of(state), *move.guard, *leave),
        move.resets,
        (*invariant_of(target), *enter),
    )
    return PathStep(timed, move, target)


def mark_step(state: State, holds: Piece, resets: Sequence[int] = ()) -> PathStep:
    """An instant at which something holds, and some clocks of the query start."""
    leave = (*invariant_of(state), *holds)
    return PathStep(
        TimedStep(state.delays, leave, tuple((clock, 0.0) for clock in resets), ()), None, state
    )


def crossing_step(state: State, leave: Piece, enter: Piece) -> PathStep:
    """The instant at which a run crosses from one piece of a formula to another."""
    timed = TimedStep(state.delays, (*invariant_of(state), *leave), (), enter)
    return PathStep(timed, None, state)


def make_run(
    network: Network,
    start: State,
    steps: Sequence[PathStep],
    ending: Ending = Ending.REACHED,
    loop: int | None = None,
) -> Run:
    """The run along a path that does everything as early as possible.

    Args:
        network: whose run is shown. The path may be of another that has more automata, clocks and
            variables behind those of this one.
        start: where it starts.
        steps: the path.
        ending: how the run ends.
        loop: the first step that is repeated, of a loop.
    """
    timing = timing_of([step.timed for step in steps])
    assert timing is not None, "the search found a run along the path"
    run_steps = tuple(
        RunStep(window, wait, _action(network, step.move), _position(network, step.state))
        for step, window, wait in zip(steps, windows(timing), earliest(timing), strict=True)
    )
    run = Run(_position(network, start), run_steps, ending, loop, timing)
    Rules(network).replay(run)
    return run


def _action(network: Network, move: Move | None) -> Action | None:
    edges = tuple(
        (edge.automaton, network.automata[edge.automaton].edges[edge.number])
        for edge in (() if move is None else move.edges)
        if edge.automaton < len(network.automata)
    )
    return Action(edges) if edges else None


def _position(network: Network, state: State) -> Position:
    automata, variables = len(network.automata), len(network.variables)
    return Position(state.locations[:automata], state.values[:variables])
