"""Random tests: sequences of any actions, and sequences constrained to start by the protocol."""

from __future__ import annotations

import random
from typing import Literal, get_args

from handover.generator.abstract_test import (
    AbstractTest,
    Action,
    HumanSignal,
    Parameter,
    ReceiveSignal,
    RobotSignal,
    SendSignal,
    SetParam,
)

LENGTH = (4, 15)
"""Number of actions of a pseudorandom test, uniform."""

TAIL_LENGTH = (1, 10)
"""Number of random actions after the prefix of a constrained test, uniform."""

TIME = (1, 100)
"""Duration of a wait in units of 0.05 s, uniform."""

PREFIX: tuple[Action, ...] = (
    SendSignal("activateRobot"),
    SetParam("time", 40),
    ReceiveSignal("informHumanOfHandoverStart"),
    SendSignal("humanIsReady"),
    SetParam("time", 10),
    SendSignal("setv"),
)
"""The protocol up to the human's readiness, with which every constrained test starts."""

_HUMAN_SIGNALS: tuple[HumanSignal, ...] = get_args(HumanSignal)
_ROBOT_SIGNALS: tuple[RobotSignal, ...] = get_args(RobotSignal)
_PARAMETERS: tuple[Parameter, ...] = get_args(Parameter)


def pseudorandom(count: int, seed: int) -> tuple[AbstractTest, ...]:
    """Tests of uniformly random actions, whether or not they make sense together.

    Source: Araiza-Illan et al. 2015, "Coverage-Driven Verification", section 3.3; lengths and
    actions as in its public testbench.

    >>> [len(test.actions) for test in pseudorandom(3, seed=1)]
    [11, 11, 5]
    """
    return tuple(_test("pseudorandom", seed, place, (), LENGTH) for place in range(count))


def constrained(count: int, seed: int) -> tuple[AbstractTest, ...]:
    """Tests in which the human follows the protocol up to being ready, then acts at random.

    Source: as `pseudorandom`.

    >>> all(test.actions[:6] == PREFIX for test in constrained(3, seed=1))
    True
    """
    return tuple(_test("constrained", seed, place, PREFIX, TAIL_LENGTH) for place in range(count))


def _test(
    strategy: Literal["pseudorandom", "constrained"],
    seed: int,
    place: int,
    prefix: tuple[Action, ...],
    lengths: tuple[int, int],
) -> AbstractTest:
    rng = random.Random(f"{strategy}/{seed}/{place}")  # noqa: S311  # repeatable, not secret
    actions = tuple(_random_action(rng) for _ in range(rng.randint(*lengths)))
    return AbstractTest(
        name=f"{strategy}-{place:03}",
        strategy=strategy,
        seed=rng.getrandbits(32),
        actions=prefix + actions,
    )


def _random_action(rng: random.Random) -> Action:
    match rng.randrange(3):
        case 0:
            return SendSignal(rng.choice(_HUMAN_SIGNALS))
        case 1:
            return ReceiveSignal(rng.choice(_ROBOT_SIGNALS))
        case _:
            param = rng.choice(_PARAMETERS)
            return SetParam(param, rng.randint(*TIME) if param == "time" else rng.randint(0, 1))
