"""Paths to runs: the exact window of each wait, and a concrete run, checked by the plain rules."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

from rvmon.timed.model.network import Network
from rvmon.timed.runs.concrete import replay
from rvmon.timed.runs.paths import (
    PathStep,
    crossing_path,
    crossing_step,
    invariant_of,
    mark_step,
    move_step,
    stride_path,
)
from rvmon.timed.runs.run import Action, Ending, Position, Run, RunStep
from rvmon.timed.runs.timing import earliest, timing_of, windows
from rvmon.timed.search.liveness import Escape, Staying
from rvmon.timed.search.problem import Node
from rvmon.timed.search.respond import BoundedLink, BoundedSite
from rvmon.timed.zones.dbm import Zone, cut, delay, normalise, reset, zero
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.federation import constraint_of
from rvmon.timed.zones.stay import Crossing, StaySite
from rvmon.timed.zones.zone_unions import EVERYWHERE


def plain_path(node: Node[State, Move]) -> list[PathStep]:
    """The moves to a node of a search over discrete states."""
    nodes = node.path()
    return move_path(nodes[0].site, [after.link for after in nodes[1:] if after.link is not None])


def move_path(start: State, moves: Iterable[Move]) -> list[PathStep]:
    """Moves in turn."""
    steps, here = [], start
    for move in moves:
        steps.append(move_step(here, move))
        here = move.target
    return steps


def bounded_path(node: Node[BoundedSite, BoundedLink], timer: int) -> list[PathStep]:
    """The steps to a node of a search for a late response."""
    nodes = node.path()
    steps = []
    for before, after in pairwise(nodes):
        here, link, behind = before.site, after.link, after.site
        match link:
            case Move():
                leave = here.constraint if isinstance(here, StaySite) else EVERYWHERE
                enter = behind.constraint if isinstance(behind, StaySite) else EVERYWHERE
                steps.append(move_step(state_of(here), link, leave, enter))
            case Crossing():
                assert isinstance(here, StaySite)  # noqa: S101 - crossings join pieces
                steps.append(crossing_step(here, link))
            case tuple():
                steps.append(mark_step(state_of(here), link, [timer]))
            case None:
                raise AssertionError("only the first node has no link")
    return steps


def state_of(site: BoundedSite) -> State:
    """The discrete state of a site."""
    return site.state if isinstance(site, StaySite) else site


def escape_path(
    escape: Escape, staying: Staying, stem: Sequence[PathStep], dim: int
) -> list[PathStep]:
    """The steps of a way to stay inside, behind those that lead to its start."""
    steps = [*stem, *stride_path(escape.start, escape.strides)]
    last = escape.strides[-1][1] if escape.strides else escape.start
    steps += crossing_path(last, escape.crossings)
    if escape.crossings:
        last = escape.crossings[-1].target
    if escape.ending is Ending.TIME_LOCK:
        zone = zone_after(steps, dim)
        if last.state.delays:
            delay(zone, dim)
            cut(zone, dim, (*invariant_of(last.state), *last.constraint))
        stuck = staying.stuck(last, normalise(zone))
        steps.append(mark_step(last.state, constraint_of(stuck[0], dim)))
    return steps


def zone_after(steps: Sequence[PathStep], dim: int) -> Zone:
    """The exact valuations at the instant behind the last step of a path."""
    zone = zero(dim)
    for step in steps:
        if step.timed.waits:
            delay(zone, dim)
        cut(zone, dim, step.timed.leave)
        for clock, value in step.timed.resets:
            reset(zone, dim, clock, value)
        cut(zone, dim, step.timed.enter)
        zone = normalise(zone)
    return zone


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
