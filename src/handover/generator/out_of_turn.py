"""Tests of a human who follows the protocol but takes some steps too early or too late.

Sensors and scene may be disturbed as well, as in tests of the strategy `disturbed`.
"""

from __future__ import annotations

import random
from collections.abc import Collection, Sequence
from typing import get_args

from handover.generator.abstract_test import (
    AbstractTest,
    Action,
    Posture,
    ReceiveSignal,
    SendSignal,
    SetParam,
)
from handover.generator.disturbed import DELAY_S, GREASY, LOSS, NOISE_M, PLAN_FAILURE
from handover.world.faults import SceneFaults, SensorFaults
from rvmon.cdv.campaign import Choose

_TURNS = ("before activating", "after activating", "before being ready", "after being ready")
_POSTURES: tuple[Posture, ...] = get_args(Posture)

_PAUSES = ((0, 20), (0, 20), (60, 180), (240, 258), (315, 385))
"""Ranges of pauses, in units of 0.05 s. The third range is about the time that the robot takes to
come; the last is nearly too long."""

_SENSORS = {
    "noisy": SensorFaults(noise_m=NOISE_M[1]),
    "late": SensorFaults(delay_s=DELAY_S[1]),
    "lossy": SensorFaults(loss=LOSS[1]),
}
_SCENES = {
    "greasy": SceneFaults(friction=GREASY),
    "few paths": SceneFaults(plan_failure=PLAN_FAILURE[1]),
    "no path": SceneFaults(plan_failure=1.0),
}
_AFTERWARDS: dict[str, tuple[Action, ...]] = {
    "stays": (),
    "lets go": (SetParam("hpressureOk", 0),),
    "looks away": (SetParam("hgazeOk", 0),),
    "says it again": (SendSignal("humanIsReady"),),
}


def out_of_turn(choose: Choose, seed: int) -> AbstractTest:
    """A test whose order of steps, postures and pauses are chosen; the seed determines the rest.

    >>> test = out_of_turn(lambda _name, options: options[0], seed=1)
    >>> [action.param for action in test.actions[:3]]
    ['hgazeOk', 'hlocationOk', 'hpressureOk']
    """
    rng = random.Random(f"out of turn/{seed}")  # noqa: S311 - repeatable, not secret
    turns: dict[str, list[Action]] = {turn: [] for turn in _TURNS}
    for posture in _POSTURES:
        turn = choose(f"turn of {posture}", _TURNS)
        turns[turn].append(SetParam(posture, choose(posture, (1, 1, 1, 0))))
    before, activated, ready, after = (turns[turn] for turn in _TURNS)
    pauses = {
        what: SetParam("time", rng.randint(*choose(f"pause {what}", _PAUSES)))
        for what in ("before activating", "before being ready", "afterwards")
    }
    is_patient = choose("waits to be informed", (True, True, False))
    return AbstractTest(
        name=f"out-of-turn-{seed}",
        strategy="closed",
        seed=rng.getrandbits(32),
        actions=(
            *before,
            pauses["before activating"],
            SendSignal("activateRobot"),
            *activated,
            *([ReceiveSignal("informHumanOfHandoverStart")] if is_patient else []),
            pauses["before being ready"],
            *ready,
            SendSignal("humanIsReady"),
            *after,
            pauses["afterwards"],
            *_AFTERWARDS[choose("afterwards", tuple(_AFTERWARDS))],
        ),
        faults=_SENSORS.get(choose("sensors", _mostly_sound(_SENSORS)), SensorFaults()),
        scene=_SCENES.get(choose("scene", _mostly_sound(_SCENES)), SceneFaults()),
    )


def _mostly_sound(faults: Collection[str]) -> Sequence[str]:
    """Options for a choice among faults, half of which are no fault."""
    return (*faults, *["sound"] * len(faults))
