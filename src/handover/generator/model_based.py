"""Tests from the model: query → witness → template of the human's part → chosen times."""

from __future__ import annotations

import random
from functools import cache
from math import floor, inf
from typing import TYPE_CHECKING, Literal

from handover.generator.abstract_test import (
    SEND_DELAY_S,
    SEND_PAUSE_S,
    AbstractTest,
    Action,
    ReceiveSignal,
    SendSignal,
    SetParam,
    Strategy,
)
from handover.generator.files import AbstractTestError
from handover.generator.template import (
    Limit,
    PolicyName,
    Template,
    TemplateStep,
    Wait,
    save_template,
)

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence
    from pathlib import Path

    from rvmon.timed.model.network import Network
    from rvmon.timed.runs.run import Run

REQUIREMENTS = ("R1", "R2", "R3", "R4")
"""The queries whose witnesses become templates; R5 has none, for the model knows no distances."""

PROJECTED = ("workflow", "gaze", "location", "pressure", "sensors")
"""The automata that are not the robot."""

PATIENCE = 40
"""Units of time by which a wait may exceed its least one.

The longest waits of a witness need a robot that waits as long; two seconds are enough to vary.
"""

_STRATEGIES: dict[PolicyName, Strategy] = {
    "likely": "model-based",
    "shortest": "model-based-shortest",
    "fastest": "model-based-fastest",
}
_Edge = tuple[str, str, str]
_POSTURES: tuple[tuple[str, Literal["hgazeOk", "hlocationOk", "hpressureOk"]], ...] = (
    ("gaze", "hgazeOk"),
    ("location", "hlocationOk"),
    ("pressure", "hpressureOk"),
)
_ACTIONS: dict[_Edge, Action] = {
    ("workflow", "idle", "waitInform"): SendSignal("activateRobot"),
    ("workflow", "waitInform", "informed"): ReceiveSignal("informHumanOfHandoverStart"),
    ("workflow", "informed", "ready"): SendSignal("humanIsReady"),
    ("workflow", "ready", "tasking"): SetParam("honTask", 1),
    ("workflow", "ready", "end"): SetParam("honTask", 0),
    **{(who, "off", "ok"): SetParam(name, 1) for who, name in _POSTURES},
    **{(who, "off", "bad"): SetParam(name, 0) for who, name in _POSTURES},
    **{(who, "ok", "bad"): SetParam(name, 0) for who, name in _POSTURES},
}
"""What the human's script does for an edge; other edges of the projection need no action."""


def model_based(_count: int, seed: int, policy: PolicyName = "likely") -> tuple[AbstractTest, ...]:
    """One test for each of the seed's requirements that the model can express.

    Args:
        _count: ignored, as there is one witness for each requirement.
        seed: chooses the times within the witness's windows, and all that the world draws.
        policy: which witness becomes the template, if there are several.

    Source: Araiza-Illan et al. 2015, "Coverage-Driven Verification", section 3.3; Nielsen and
    Skou, Automated Test Generation from Timed Automata, 2003.

    >>> [test.name for test in model_based(4, seed=1)]
    ['model-based-R1', 'model-based-R2', 'model-based-R3', 'model-based-R4']
    """
    return tuple(instantiate(template, seed) for template in templates(policy))


@cache
def templates(policy: PolicyName = "likely") -> tuple[Template, ...]:
    """The templates of the requirements, from witnesses that the model checker chooses.

    Raises:
        AbstractTestError: a query has no witness.
    """
    from handover.model import handover_network
    from rvmon.timed.search.outcome import Policy
    from rvmon.timed.search.verify import verify

    network = handover_network()
    found = []
    for query in network.queries:
        if query.id in REQUIREMENTS:
            run = verify(network, query, policy=Policy(policy)).run
            if run is None:
                raise AbstractTestError(f"the model has no run that shows {query.id}")
            steps, limits = project(network, run)
            unit_s = (network.unit or 0) / 1e9
            text = " ".join(query.text.split())
            found.append(Template(query.id, query.remark, text, policy, unit_s, steps, limits))
    return tuple(found)


def save_templates(strategies: Collection[str], folder: Path) -> None:
    """Write the templates of those strategies that take tests from the model.

    Args:
        strategies: names of any strategies.
        folder: gets a folder for each strategy that has templates.
    """
    for policy, strategy in _STRATEGIES.items():
        if strategy in strategies:
            own = folder / strategy
            own.mkdir(parents=True, exist_ok=True)
            for template in templates(policy):
                save_template(template, own)


def project(network: Network, run: Run) -> tuple[tuple[TemplateStep, ...], tuple[Limit, ...]]:
    """What of a run concerns the human and the sensors, with all limits between its instants.

    The closed difference constraints of the run, restricted to those instants, are exactly the
    limits that the whole run puts on them.
    """
    timing = run.timing
    assert timing is not None  # noqa: S101 - the model checker knows the timing of its runs
    instants, texts, actions = [0], [""], list[Action | None]([None])
    for number, step in enumerate(run.steps, start=1):
        for index, edge in [] if step.action is None else step.action.edges:
            automaton = network.automata[index]
            if automaton.name not in PROJECTED:
                continue
            source, target = (automaton.locations[i].name for i in (edge.source, edge.target))
            instants.append(number)
            texts.append(f"{automaton.name}: {source} → {target}")
            actions.append(_ACTIONS.get((automaton.name, source, target)))
    # Human and sensors act in whole units: a limit between two units is the next one inside.
    within = [
        [floor(bound / timing.scale) if (bound := float(timing.bounds[p, q])) < inf else inf
         for q in instants]
        for p in instants
    ]  # fmt: skip
    steps = tuple(
        TemplateStep(texts[now], _wait(within, now - 1, now), actions[now])
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


def instantiate(template: Template, seed: int) -> AbstractTest:
    """A test whose times were chosen within the limits of a template.

    Raises:
        AbstractTestError: no whole numbers of units satisfy the limits.
    """
    rng = random.Random(f"model-based/{seed}/{template.name}")  # noqa: S311  # repeatable
    times = choose_times(template, rng)
    strategy = _STRATEGIES[template.policy]
    return AbstractTest(
        name=f"{strategy}-{template.name}",
        strategy=strategy,
        seed=rng.getrandbits(32),
        actions=tuple(_script(template, times)),
        text=f"{template.query} ({template.policy} witness)",
    )


def choose_times(template: Template, rng: random.Random) -> list[int]:
    """Instants of all steps in units since the start, the start first.

    They are fixed in turn, each within what those before it leave open.

    Raises:
        AbstractTestError: the limits contradict each other.
    """
    size = len(template.steps) + 1
    most = [[0.0 if p == q else inf for q in range(size)] for p in range(size)]
    neighbours = [
        Limit(last - 1, last, step.wait) for last, step in enumerate(template.steps, start=1)
    ]
    for limit in (*neighbours, *template.limits):
        first, last, wait = limit.first, limit.last, limit.wait
        most[last][first] = min(most[last][first], -wait.at_least)
        if wait.at_most is not None:
            most[first][last] = min(most[first][last], wait.at_most)
    for middle in range(size):
        for p in range(size):
            for q in range(size):
                most[p][q] = min(most[p][q], most[p][middle] + most[middle][q])
    if any(most[p][p] < 0 for p in range(size)):
        raise AbstractTestError(f"template {template.name}: no times satisfy all of its limits")
    times = [0]
    for step in range(1, size):
        low = max(times[p] - most[step][p] for p in range(step))
        high = min(times[p] + most[p][step] for p in range(step))
        times.append(rng.randint(int(low), int(min(high, low + PATIENCE))))
    return times


def _script(template: Template, times: Sequence[int]) -> list[Action]:
    """The script that does each action at its time, as far as the driver's own delays allow."""
    script: list[Action] = []
    now = 0
    for step, time in zip(template.steps, times[1:], strict=True):
        if step.action is None:
            continue
        sends = isinstance(step.action, SendSignal)
        begin = time - (round(SEND_DELAY_S / template.unit_s) if sends else 0)
        if isinstance(step.action, ReceiveSignal):
            now = time  # when the robot speaks is its own affair: the script waits as long
        elif begin > now:
            script.append(SetParam("time", begin - now))
            now = begin
        script.append(step.action)
        if sends:
            now = max(now, begin) + round((SEND_DELAY_S + SEND_PAUSE_S) / template.unit_s)
    return script
