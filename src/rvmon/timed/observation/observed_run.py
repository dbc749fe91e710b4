"""Paths of a network with a monitor to runs of the network.

The monitor's clocks are renamed and dropped on the way; each is the time since some step of the
path, so along a path a clock of its own for every step says the same.
"""

from __future__ import annotations

from itertools import pairwise

from rvmon.automaton.location import NOW
from rvmon.timed.model.network import Network
from rvmon.timed.observation.observer import Observed, ObservedLink, ObservedSite, Phase
from rvmon.timed.runs.paths import PathStep, invariant_of
from rvmon.timed.runs.run import Run
from rvmon.timed.runs.timing import TimedStep
from rvmon.timed.search.problem import Node
from rvmon.timed.search.witness import make_run
from rvmon.timed.zones.dbm import STRICT
from rvmon.timed.zones.zone_unions import Constraint


def observed_run(
    network: Network, problem: Observed, node: Node[ObservedSite, ObservedLink]
) -> Run:
    """The run that leads to a node of the product."""
    nodes = node.path()
    clock_of = dict.fromkeys(range(problem.base, problem.dim), problem.dim)
    steps = []
    for number, (before, after) in enumerate(pairwise(nodes), start=1):
        assert after.link is not None  # noqa: S101 - only the first node has no link
        own = problem.dim + number
        steps.append(_step(problem, before.site, after.link, after.site, clock_of, own))
    return make_run(network, nodes[0].site.state, steps)


def _step(
    problem: Observed,
    here: ObservedSite,
    link: ObservedLink,
    behind: ObservedSite,
    clock_of: dict[int, int],
    own: int,
) -> PathStep:
    """One instant; `clock_of` says which step's clock each of the monitor's clocks is."""
    state, move = here.state, link.move
    leave: list[Constraint] = [invariant_of(state)]
    if here.phase is Phase.HELD:
        held = (*problem.held(here.location, here.region), (problem.since, 0, -STRICT))
        leave.append(_renamed(held, clock_of))
    if move is not None:
        leave.append(move.guard)
    for step in link.steps:
        leave.append(_renamed(step.constraint, clock_of))
        sources = [own if s == NOW else clock_of[problem.base + s] for s in step.sources]
        clock_of.update(enumerate(sources, start=problem.base))
    resets: tuple[tuple[int, float], ...] = ((own, 0.0),)
    if move is not None:
        clock_of[problem.since] = own
        resets = (*move.resets, *resets)
    waits = state.delays and here.phase is not Phase.FRESH
    bounds = tuple(bound for constraint in leave for bound in constraint)
    timed = TimedStep(waits, bounds, resets, invariant_of(behind.state))
    return PathStep(timed, move, behind.state)


def _renamed(constraint: Constraint, clock_of: dict[int, int]) -> Constraint:
    return tuple((clock_of.get(x, x), clock_of.get(y, y), bound) for x, y, bound in constraint)
