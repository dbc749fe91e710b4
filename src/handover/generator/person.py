"""A person as a Markov chain: what people do at a handover, and how often they do otherwise."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from typing import Literal

from handover.generator.abstract_test import (
    Action,
    ReceiveSignal,
    SendSignal,
    SetParam,
    Withdraw,
)

State = Literal["arrives", "waits", "attends", "takes", "holds", "leaves"]
Acts = Callable[[random.Random], Sequence[Action]]

OK = 0.9
"""Probability that a posture is taken up rightly, as the model's weights have it."""

LONGEST = 24
"""Actions after which a person who goes in circles leaves."""


def _pause(shortest_s: float, longest_s: float) -> Acts:
    """Wait for a uniform time."""
    return lambda rng: [SetParam("time", round(rng.uniform(shortest_s, longest_s) / 0.05))]


def _say(signal: Literal["activateRobot", "humanIsReady"]) -> Acts:
    return lambda _: [SendSignal(signal)]


def _take(rng: random.Random) -> Sequence[Action]:
    """Look, reach and close the hand, in any order and not all at once."""
    postures = [
        SetParam("hgazeOk", int(rng.random() < OK)),
        SetParam("hlocationOk", int(rng.random() < OK)),
        SetParam("hpressureOk", int(rng.random() < OK)),
    ]
    rng.shuffle(postures)
    return [step for one in postures for step in (*_pause(0.0, 0.8)(rng), one)]


def _reach_early(rng: random.Random) -> Sequence[Action]:
    """Reach for the piece while the robot fetches it."""
    grasp = SetParam("hpressureOk", 1)
    return [*_pause(0.0, 15.0)(rng), SetParam("hlocationOk", 1), *([grasp] * rng.randint(0, 1))]


def _one(action: Action) -> Acts:
    return lambda _: [action]


PERSON: Mapping[State, Sequence[tuple[float, Acts, State]]] = {
    "arrives": (
        (0.84, _say("activateRobot"), "waits"),
        (0.08, _say("humanIsReady"), "arrives"),  # the wrong signal
        (0.08, _pause(1.0, 20.0), "arrives"),  # perhaps too long
    ),
    "waits": (
        (0.74, _one(ReceiveSignal("informHumanOfHandoverStart")), "attends"),
        (0.12, _reach_early, "waits"),
        (0.06, _say("humanIsReady"), "waits"),  # too early
        (0.04, _say("activateRobot"), "waits"),
        (0.04, _one(Withdraw()), "waits"),
    ),
    "attends": (
        (0.77, _say("humanIsReady"), "takes"),
        (0.08, _say("activateRobot"), "attends"),  # the wrong signal
        (0.05, _take, "attends"),  # takes it first
        (0.05, _pause(1.0, 20.0), "attends"),
        (0.05, _one(Withdraw()), "leaves"),
    ),
    "takes": (
        (0.85, _take, "holds"),
        (0.05, _pause(1.0, 6.0), "takes"),  # perhaps longer than the robot senses
        (0.05, _one(SetParam("honTask", 0)), "leaves"),
        (0.05, _one(Withdraw()), "leaves"),
    ),
    "holds": (
        (0.70, _pause(0.0, 1.0), "leaves"),
        (0.10, _pause(0.0, 1.0), "holds"),
        (0.08, _one(SetParam("hpressureOk", 0)), "leaves"),  # opens the hand: drops it
        (0.07, _one(Withdraw()), "leaves"),
        (0.05, _one(SetParam("hgazeOk", 0)), "leaves"),
    ),
}
"""State to probability, what is done, and the state after.

The weights of the network (`handover.ta`) give the share of bad postures and of those who lose
interest, 0.05 at each step. The other deviations have no published rates: each has so much that
among 100 tests several show it, and that three of ten follow the protocol to its end.
"""


def behave(rng: random.Random) -> tuple[Action, ...]:
    """What one person does, from arriving to leaving.

    Source: as the seed's closing section asks for; a Markov usage model (Whittaker and Thomason
    1994, "A Markov chain model for statistical software testing").

    >>> behave(random.Random(2))[0]
    SendSignal(signal='activateRobot')
    """
    actions: list[Action] = []
    state: State = "arrives"
    while state != "leaves" and len(actions) < LONGEST:
        (_, acts, state), *_ = rng.choices(
            PERSON[state], weights=[weight for weight, _, _ in PERSON[state]]
        )
        actions += acts(rng)
    return tuple(actions)
