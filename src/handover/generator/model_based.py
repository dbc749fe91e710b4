"""Tests from the model: a query's witness becomes a template of the human's part, then a test."""

from __future__ import annotations

import random
from functools import cache
from typing import TYPE_CHECKING

from handover.generator.abstract_test import (
    SEND_DELAY_S,
    SEND_PAUSE_S,
    AbstractTest,
    Action,
    Posture,
    ReceiveSignal,
    SendSignal,
    SetParam,
    Strategy,
)
from rvmon.cdv.template import Edge, PolicyName, Template, choose_times, save_template, templates_of

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence
    from pathlib import Path

REQUIREMENTS = ("R1", "R2", "R3", "R4")
"""The queries whose witnesses become templates; R5 has none, as the model has no distances."""

PROJECTED = ("workflow", "gaze", "location", "pressure", "sensors")
"""The automata that are not the robot."""

PATIENCE = 40
"""Units of time by which a wait may exceed its minimum.

The robot would not wait for the longest waits that a witness allows; 2 s give enough variation.
"""

_STRATEGIES: dict[PolicyName, Strategy] = {
    "likely": "model-based",
    "shortest": "model-based-shortest",
    "fastest": "model-based-fastest",
}
_POSTURES: dict[str, Posture] = {
    "gaze": "hgazeOk", "location": "hlocationOk", "pressure": "hpressureOk"
}  # fmt: skip
ACTIONS: dict[Edge, Action] = {
    ("workflow", "idle", "waitInform"): SendSignal("activateRobot"),
    ("workflow", "waitInform", "informed"): ReceiveSignal("informHumanOfHandoverStart"),
    ("workflow", "informed", "ready"): SendSignal("humanIsReady"),
    ("workflow", "ready", "tasking"): SetParam("honTask", 1),
    ("workflow", "ready", "end"): SetParam("honTask", 0),
    **{(who, "off", "ok"): SetParam(name, 1) for who, name in _POSTURES.items()},
    **{
        (who, was, "bad"): SetParam(name, 0)
        for was in ("off", "ok")
        for who, name in _POSTURES.items()
    },
}
"""The action of the human's script for an edge; other edges of the projection need none."""


def model_based(_count: int, seed: int, policy: PolicyName = "likely") -> tuple[AbstractTest, ...]:
    """One test for each of the seed paper's requirements that the model can express.

    Args:
        _count: ignored, as there is one witness per requirement.
        seed: determines the times within the limits of the witness, and everything random.
        policy: how the witness is chosen among several.

    Source: Araiza-Illan et al. 2015, "Coverage-Driven Verification", section 3.3; Nielsen and
    Skou, Automated Test Generation from Timed Automata, 2003.

    >>> [test.name for test in model_based(4, seed=1)]
    ['model-based-R1', 'model-based-R2', 'model-based-R3', 'model-based-R4']
    """
    return tuple(instantiate(template, seed) for template in templates(policy))


@cache
def templates(policy: PolicyName = "likely") -> tuple[Template[Action], ...]:
    """The templates of the requirements, made from witnesses of the model checker.

    Raises:
        TestError: a query has no witness.
    """
    from handover.model import handover_network

    return templates_of(handover_network(), REQUIREMENTS, PROJECTED, ACTIONS, policy)


def save_templates(strategies: Collection[str], folder: Path) -> None:
    """Write the templates of each model-based strategy to a subfolder of its name."""
    for policy, strategy in _STRATEGIES.items():
        if strategy in strategies:
            own = folder / strategy
            own.mkdir(parents=True, exist_ok=True)
            for template in templates(policy):
                save_template(template, own)


def instantiate(template: Template[Action], seed: int) -> AbstractTest:
    """A test with times drawn within the limits of a template.

    Raises:
        TestError: no times in whole units satisfy the limits.
    """
    rng = random.Random(f"model-based/{seed}/{template.name}")  # noqa: S311  # repeatable
    times = choose_times(template, rng, PATIENCE)
    strategy = _STRATEGIES[template.policy]
    return AbstractTest(
        name=f"{strategy}-{template.name}",
        strategy=strategy,
        seed=rng.getrandbits(32),
        actions=tuple(_script(template, times)),
        text=f"{template.query} ({template.policy} witness)",
    )


def _script(template: Template[Action], times: Sequence[int]) -> list[Action]:
    """The script that starts each action at its time, as far as the driver's delays allow."""
    script: list[Action] = []
    now = 0
    for step, time in zip(template.steps, times[1:], strict=True):
        if step.action is None:
            continue
        sends = isinstance(step.action, SendSignal)
        begin = time - (round(SEND_DELAY_S / template.unit_s) if sends else 0)
        if isinstance(step.action, ReceiveSignal):
            now = time  # the script waits until the robot sends, whenever that is
        elif begin > now:
            script.append(SetParam("time", begin - now))
            now = begin
        script.append(step.action)
        if sends:
            now = max(now, begin) + round((SEND_DELAY_S + SEND_PAUSE_S) / template.unit_s)
    return script
