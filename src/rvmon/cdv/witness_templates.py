"""Test templates from a model: query → witness → what of it concerns the test."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from math import floor, inf
from typing import TYPE_CHECKING

from rvmon.cdv.files import TestError
from rvmon.cdv.template import Action, Limit, PolicyName, Template, TemplateStep, Wait

if TYPE_CHECKING:
    from rvmon.timed.model.network import Network
    from rvmon.timed.runs.run import Run

Edge = tuple[str, str, str]
"""An edge of a network: automaton, location before, location after."""


def templates_of(
    network: Network,
    queries: Collection[str],
    automata: Collection[str],
    actions: Mapping[Edge, Action],
    policy: PolicyName,
) -> tuple[Template[Action], ...]:
    """The templates of a model's queries, from witnesses that the model checker chooses.

    Args:
        network: the model.
        queries: ids of its queries that tests are to show.
        automata: names of those that tests stand for, such as people and sensors.
        actions: what a test does for their edges; those left out need no action.
        policy: how a witness is chosen among several.

    Raises:
        TestError: a query has no witness.
    """
    from rvmon.timed.search.outcome import Policy
    from rvmon.timed.search.verify import verify

    found = []
    for query in network.queries:
        if query.id in queries:
            run = verify(network, query, policy=Policy(policy)).run
            if run is None:
                raise TestError(f"the model has no run that shows {query.id}")
            steps, limits = project(network, run, automata, actions)
            unit_s = (network.unit or 0) / 1e9
            text = " ".join(query.text.split())
            found.append(Template(query.id, query.remark, text, policy, unit_s, steps, limits))
    return tuple(found)


def project(
    network: Network, run: Run, automata: Collection[str], actions: Mapping[Edge, Action]
) -> tuple[tuple[TemplateStep[Action], ...], tuple[Limit, ...]]:
    """What of a run concerns some automata, with all limits between its instants.

    The closed difference constraints of the run, restricted to those instants, are exactly the
    limits that the whole run puts on them.

    Args:
        network: whose run it is.
        run: as the model checker gives it.
        automata: names of those that are kept.
        actions: what a test does for their edges.
    """
    timing = run.timing
    assert timing is not None  # noqa: S101 - the model checker knows the timing of its runs
    instants, texts, taken = [0], [""], list[Action | None]([None])
    for number, step in enumerate(run.steps, start=1):
        for index, edge in [] if step.action is None else step.action.edges:
            automaton = network.automata[index]
            if automaton.name not in automata:
                continue
            source, target = (automaton.locations[i].name for i in (edge.source, edge.target))
            instants.append(number)
            texts.append(f"{automaton.name}: {source} → {target}")
            taken.append(actions.get((automaton.name, source, target)))
    # A test acts in whole units: a limit between two units is the next one inside.
    within = [
        [floor(bound / timing.scale) if (bound := float(timing.bounds[p, q])) < inf else inf
         for q in instants]
        for p in instants
    ]  # fmt: skip
    steps = tuple(
        TemplateStep(texts[now], _wait(within, now - 1, now), taken[now])
        for now in range(1, len(instants))
    )
    limits = tuple(
        Limit(first, last, wait)
        for first in range(len(instants))
        for last in range(first + 2, len(instants))
        if (wait := _wait(within, first, last)) != Wait(0)
    )
    return steps, limits


def _wait(within: Sequence[Sequence[float]], first: int, last: int) -> Wait:
    """The limits between two instants, without those that the instants between imply."""
    middle = range(first + 1, last)
    low, high = -within[last][first], within[first][last]
    if any(-within[k][first] - within[last][k] == low for k in middle):
        low = 0
    if any(within[first][k] + within[k][last] == high for k in middle):
        high = inf
    return Wait(int(low), None if high == inf else int(high))
