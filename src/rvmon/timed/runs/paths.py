"""Paths of symbolic states step by step, and the runs along them.

A run has the exact window of each wait, and concrete times that the plain rules have checked.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rvmon.timed.model.network import Network
from rvmon.timed.runs.concrete import replay
from rvmon.timed.runs.run import Action, Ending, Position, Run, RunStep
from rvmon.timed.runs.timing import TimedStep, earliest, timing_of, windows
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.zone_unions import EVERYWHERE, Constraint


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


def invariant_of(state: State) -> Constraint:
    """A state's invariant as bounds."""
    return tuple((0, clock, bound) for clock, bound in state.invariant)


def move_step(
    state: State, move: Move, leave: Constraint = EVERYWHERE, enter: Constraint = EVERYWHERE
) -> PathStep:
    """A move, with what else must hold before and after it."""
    target = move.target
    timed = TimedStep(
        state.delays,
        (*invariant_of(state), *move.guard, *leave),
        move.resets,
        (*invariant_of(target), *enter),
    )
    return PathStep(timed, move, target)


def mark_step(state: State, holds: Constraint, resets: Sequence[int] = ()) -> PathStep:
    """An instant at which something holds, and some clocks of the query start."""
    leave = (*invariant_of(state), *holds)
    return PathStep(
        TimedStep(state.delays, leave, tuple((clock, 0.0) for clock in resets), ()), None, state
    )


def crossing_step(state: State, leave: Constraint, enter: Constraint) -> PathStep:
    """The instant at which a run crosses from one piece of a formula to another."""
    timed = TimedStep(state.delays, (*invariant_of(state), *leave), (), enter)
    return PathStep(timed, None, state)


def move_path(start: State, moves: Iterable[Move]) -> list[PathStep]:
    """Moves in turn."""
    steps, here = [], start
    for move in moves:
        steps.append(move_step(here, move))
        here = move.target
    return steps


def make_run(
    network: Network,
    start: State,
    steps: Sequence[PathStep],
    ending: Ending = Ending.REACHED,
    loop: int | None = None,
) -> Run:
    """The run along a path that does everything as early as possible."""
    timing = timing_of([step.timed for step in steps])
    assert timing is not None, "the search found a run along the path"
    run_steps = tuple(
        RunStep(window, wait, action_of(step.move), position_of(step.state))
        for step, window, wait in zip(steps, windows(timing), earliest(timing), strict=True)
    )
    run = Run(position_of(start), run_steps, ending, loop, timing)
    replay(network, run)
    return run


def action_of(move: Move | None) -> Action | None:
    """The edges of a move."""
    if move is None:
        return None
    return Action(tuple((edge.automaton, edge.edge) for edge in move.edges))


def position_of(state: State) -> Position:
    """A discrete state as runs show it."""
    return Position(state.vector.locations, state.values)
