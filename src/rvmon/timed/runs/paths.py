"""Paths of symbolic states step by step: what is done, where it leads, when it can happen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.timed.runs.timing import TimedStep
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
