"""Paths to runs: the exact window of each wait, and a concrete run, checked by the plain rules."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rvmon.timed.model.network import Network
from rvmon.timed.runs.concrete import replay
from rvmon.timed.runs.paths import PathStep, move_step
from rvmon.timed.runs.run import Action, Ending, Position, Run, RunStep
from rvmon.timed.runs.timing import earliest, timing_of, windows
from rvmon.timed.zones.discrete import Move, State


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
    assert timing is not None  # noqa: S101 - the search found a run along the path
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
