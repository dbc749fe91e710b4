"""Paths of symbolic states step by step: what is done, where it leads, when it can happen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.timed.runs.timing import TimedStep
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.stay import Crossing, StaySite, Stride
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


def crossing_step(site: StaySite, crossing: Crossing) -> PathStep:
    """The instant at which a run crosses from one piece of a formula to another."""
    state = site.state
    leave = (*invariant_of(state), *crossing.leave)
    return PathStep(TimedStep(state.delays, leave, (), crossing.enter), None, state)


def crossing_path(site: StaySite, crossings: Sequence[Crossing]) -> list[PathStep]:
    """Several crossings in turn."""
    steps = []
    for crossing in crossings:
        steps.append(crossing_step(site, crossing))
        site = crossing.target
    return steps


def stride_path(start: StaySite, strides: Sequence[tuple[Stride, StaySite]]) -> list[PathStep]:
    """Moves that stay inside a formula, with the crossings before each."""
    steps: list[PathStep] = []
    site = start
    for stride, behind in strides:
        steps += crossing_path(site, stride.crossings)
        here = stride.crossings[-1].target if stride.crossings else site
        steps.append(move_step(here.state, stride.move, here.constraint, behind.constraint))
        site = behind
    return steps
