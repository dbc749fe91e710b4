"""Tests in which sensors, scene and person deviate from the protocol.

All probabilities and ranges are defined here. The person is a Markov chain of the steps of a
handover, including deviations. In about half of the tests sensors and scene are undisturbed, so
that single disturbances are seen alone.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from typing import Final, Literal, get_args

from handover.generator.abstract_test import (
    AbstractTest,
    Action,
    ReceiveSignal,
    SendSignal,
    SetParam,
    Withdraw,
)
from handover.world.faults import SceneFaults, Sensor, SensorFaults

State = Literal["arrives", "waits", "attends", "takes", "holds", "leaves"]
Acts = Callable[[random.Random], Sequence[Action]]

OK = 0.9
"""Probability of a correct posture, as in the weights of the model."""

LONGEST = 24
"""The number of actions after which a person leaves who goes in circles."""


def _pause(shortest_s: float, longest_s: float) -> Acts:
    return lambda rng: [SetParam("time", round(rng.uniform(shortest_s, longest_s) / 0.05))]


def _say(signal: Literal["activateRobot", "humanIsReady"]) -> Acts:
    return lambda _: [SendSignal(signal)]


def _take(rng: random.Random) -> Sequence[Action]:
    """Look, reach and close the hand, in any order with pauses."""
    postures = [
        SetParam("hgazeOk", int(rng.random() < OK)),
        SetParam("hlocationOk", int(rng.random() < OK)),
        SetParam("hpressureOk", int(rng.random() < OK)),
    ]
    rng.shuffle(postures)
    return [step for posture in postures for step in (*_pause(0.0, 0.8)(rng), posture)]


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
        (0.05, _take, "attends"),  # takes it before being ready
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
"""The transitions of each state: probability, actions, and the next state.

The share of bad postures, and that of people who lose interest (0.05 at each step), are taken from
the weights of the network (`handover.ta`). All other rates and pauses are free. They are chosen so
that several of 100 tests show each deviation, and three of ten follow the protocol to its end.
People who ignore the robot or hold on to the piece have been studied with acted failures (Thoduka
et al. 2024, "A Multimodal Handover Failure Detection Dataset and Baselines", ICRA), and so has the
instant of reaching (Moon et al. 2014, "Meet me where I'm gazing", HRI, 102 people). Neither study
gives a rate.
"""


def behave(rng: random.Random) -> tuple[Action, ...]:
    """The actions of one person, from arriving to leaving.

    Source: suggested by the closing section of the seed paper; a Markov usage model (Whittaker and
    Thomason 1994, "A Markov chain model for statistical software testing").

    >>> behave(random.Random(1))[0]
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


P_SENSORS: Final = 0.3
"""The share of tests with a sensor fault; each kind is equally likely."""

NOISE_M: Final = (0.02, 0.2)
"""Body trackers with depth cameras err by centimetres at hand and head, and by decimetres when body
parts are hidden (Wang et al. 2015, "Evaluation of pose tracking accuracy in the first and second
generations of Microsoft Kinect")."""

DELAY_S: Final = (0.1, 1.0)
"""From the usual latency of a tracker to that over a loaded network."""

LOSS: Final = (0.1, 0.6)
"""The share of lost readings: from a hand that is hidden now and then to one mostly hidden."""

P_SLIPPERY: Final = 0.08
GREASY: Final = 0.02
"""Friction of greased rubber on wood; with 0.05, a piece would still stay in the gripper."""

P_PLANNER: Final = 0.12
PLAN_FAILURE: Final = (0.2, 0.8)
"""Sampling-based planners sometimes find no path in time; at 0.8, this ends half of the tasks."""

P_HIDDEN: Final = 0.08
HIDDEN: Final = (0.2, 0.8)
"""The share of looks in which a moving person hides the piece; the same range as for plans."""

P_RAISED: Final = 0.1
RAISED_M: Final = (0.01, 0.06)
"""Height of an object under the piece, from a tray to a box."""

P_EARLY: Final = 0.1
EARLY_S: Final = (0.0, 3.0)
"""Starts of the human's process at which the robot may not listen yet; the first signal comes 2 s
later."""

P_IN_PLANE: Final = 0.5
"""The hand is as often in the plane as in front of it, as a planar scene cannot tell which."""

P_BESIDE: Final = 0.12
BESIDE_M: Final = (0.35, 0.8)
"""The position of a person along x, from in the robot's way to well beside it."""

P_FAR_HAND: Final = 0.5
"""The probability that the person takes the piece with the far hand."""

P_AT_LIMITS: Final = 0.2
"""The share of tests with postures at the ends of the seed paper's ranges, its corner cases."""


FREE: Final = (
    *("PERSON", "LONGEST", "P_SENSORS", "DELAY_S", "LOSS", "P_SLIPPERY", "GREASY", "P_PLANNER"),
    *("PLAN_FAILURE", "P_HIDDEN", "HIDDEN", "P_RAISED", "RAISED_M", "P_EARLY", "EARLY_S"),
    *("P_IN_PLANE", "P_BESIDE", "BESIDE_M", "P_FAR_HAND", "P_AT_LIMITS"),
)
"""The parameters without a source; so counts of disturbed tests do not estimate frequencies."""


def disturbed(count: int, seed: int) -> tuple[AbstractTest, ...]:
    """Tests with a person who may deviate at any step, and with sensors and a scene that may fail.

    >>> [len(test.actions) for test in disturbed(3, seed=1)]
    [11, 16, 12]
    """
    return tuple(_test(random.Random(f"disturbed/{seed}/{i}"), i) for i in range(count))  # noqa: S311 - no secret


def _test(rng: random.Random, index: int) -> AbstractTest:
    return AbstractTest(
        name=f"disturbed-{index:03}",
        strategy="disturbed",
        robot="correct",
        seed=rng.getrandbits(32),
        actions=behave(rng),
        postures="at_limits" if rng.random() < P_AT_LIMITS else "in_range",
        faults=_sensor_faults(rng) if rng.random() < P_SENSORS else SensorFaults(),
        scene=_scene_faults(rng),
        arrives_s=round(rng.uniform(*EARLY_S), 2) if rng.random() < P_EARLY else None,
    )


def _sensor_faults(rng: random.Random) -> SensorFaults:
    match rng.randrange(4):
        case 0:
            return SensorFaults(noise_m=round(rng.uniform(*NOISE_M), 3))
        case 1:
            return SensorFaults(delay_s=round(rng.uniform(*DELAY_S), 2))
        case 2:
            return SensorFaults(loss=round(rng.uniform(*LOSS), 2))
        case _:
            return SensorFaults(dropout=(rng.choice(get_args(Sensor)),))


def _scene_faults(rng: random.Random) -> SceneFaults:
    slippery, planner = rng.random() < P_SLIPPERY, rng.random() < P_PLANNER
    is_beside = rng.random() < P_BESIDE
    return SceneFaults(
        friction=GREASY if slippery else SceneFaults().friction,
        plan_failure=round(rng.uniform(*PLAN_FAILURE), 2) if planner else 0.0,
        hand_in_plane=rng.random() < P_IN_PLANE,
        hidden=round(rng.uniform(*HIDDEN), 2) if rng.random() < P_HIDDEN else 0.0,
        raised_m=round(rng.uniform(*RAISED_M), 3) if rng.random() < P_RAISED else 0.0,
        beside_m=round(rng.uniform(*BESIDE_M), 2) if is_beside else None,
        far_hand=is_beside and rng.random() < P_FAR_HAND,
    )
