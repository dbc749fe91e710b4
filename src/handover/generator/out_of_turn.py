"""Tests of a human who knows the protocol and does some of it before, or after, it is time."""

from __future__ import annotations

import random
from typing import Literal

from handover.generator.abstract_test import (
    AbstractTest,
    Action,
    ReceiveSignal,
    SendSignal,
    SetParam,
)
from rvmon.cdv.closing import Choose

_TURNS = ("before activating", "after activating", "before being ready", "after being ready")
_POSTURES: tuple[Literal["hgazeOk", "hlocationOk", "hpressureOk"], ...] = (
    "hgazeOk",
    "hlocationOk",
    "hpressureOk",
)


def out_of_turn(choose: Choose, seed: int) -> AbstractTest:
    """A test whose order of things, postures and pauses are choices.

    Args:
        choose: draws them.
        seed: of all that the world draws, and of how long a pause is.

    >>> test = out_of_turn(lambda _name, options: options[0], seed=1)
    >>> [action.param for action in test.actions[:3]]
    ['hgazeOk', 'hlocationOk', 'hpressureOk']
    """
    rng = random.Random(f"out of turn/{seed}")  # noqa: S311 - repeatable, not secret
    turns: dict[str, list[Action]] = {turn: [] for turn in _TURNS}
    for posture in _POSTURES:
        turn = choose(f"turn of {posture}", _TURNS)
        turns[turn].append(SetParam(posture, choose(posture, (1, 0))))
    before, activated, ready, after = (turns[turn] for turn in _TURNS)
    pauses = {
        what: SetParam(
            "time", rng.randint(*choose(f"pause {what}", ((1, 20), (60, 180), (200, 300))))
        )
        for what in ("before activating", "before being ready")
    }
    is_patient = choose("waits to be informed", (True, False))
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
        ),
    )
