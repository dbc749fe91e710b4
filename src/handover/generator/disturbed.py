"""Tests in which sensors, scene and person do other than the protocol has it.

All that is drawn stands here and in `person.py`. Each test has a person of its own; sensors and
scene are as they should be in about half of the tests, so that one disturbance is seen alone.
"""

from __future__ import annotations

import random
from typing import Final, get_args

from handover.generator.abstract_test import AbstractTest
from handover.generator.person import behave
from handover.world.faults import SceneFaults, Sensor, SensorFaults

P_SENSORS: Final = 0.3
"""Of tests, with one fault of the sensors, each kind as often."""

NOISE_M: Final = (0.02, 0.2)
"""Body trackers with depth cameras err by some centimetres at hand and head, by decimetres when
parts are hidden (Wang et al. 2015, "Evaluation of pose tracking accuracy in the first and second
generations of Microsoft Kinect")."""

DELAY_S: Final = (0.1, 1.0)
"""From a tracker's usual latency to that of a loaded network."""

LOSS: Final = (0.1, 0.6)
"""Of readings, from a hand that is hidden now and then to one that is hidden mostly."""

P_SLIPPERY: Final = 0.08
GREASY: Final = 0.02
"""Friction of greased rubber on wood: a piece with 0.05 still stays in the gripper."""

P_PLANNER: Final = 0.12
PLAN_FAILURE: Final = (0.2, 0.8)
"""Sampling planners find no path in time now and then; at 0.8 half of the tasks end by it."""

P_HIDDEN: Final = 0.08
HIDDEN: Final = (0.2, 0.8)
"""Of looks for the piece, past a person who moves about it; as often in vain as plans are."""

P_RAISED: Final = 0.1
RAISED_M: Final = (0.01, 0.06)
"""Heights of what a piece may stand on: from a tray to a box."""

P_EARLY: Final = 0.1
EARLY_S: Final = (0.0, 3.0)
"""The human's process is up before the robot listens: its first signal comes two seconds later."""

P_IN_PLANE: Final = 0.5
"""The hand beside the gripper as often as in front of it: the plane says neither."""

P_AT_LIMITS: Final = 0.2
"""Postures at the ends of the seed's ranges: its authors' corner cases of gaze and location."""


def disturbed(count: int, seed: int) -> tuple[AbstractTest, ...]:
    """Tests with a person who may do anything, on sensors and a scene that may fail.

    >>> [len(test.actions) for test in disturbed(3, seed=1)]
    [11, 16, 12]
    """
    return tuple(_test(random.Random(f"disturbed/{seed}/{i}"), i) for i in range(count))  # noqa: S311


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
    return SceneFaults(
        friction=GREASY if slippery else SceneFaults().friction,
        plan_failure=round(rng.uniform(*PLAN_FAILURE), 2) if planner else 0.0,
        hand_in_plane=rng.random() < P_IN_PLANE,
        hidden=round(rng.uniform(*HIDDEN), 2) if rng.random() < P_HIDDEN else 0.0,
        raised_m=round(rng.uniform(*RAISED_M), 3) if rng.random() < P_RAISED else 0.0,
    )
