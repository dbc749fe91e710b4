"""Everything that a run leaves to chance, drawn once from the test's seed."""

from __future__ import annotations

import random
from dataclasses import dataclass

from handover.world import parameters as p
from handover.world.kinematics import Joints


@dataclass(frozen=True, slots=True)
class Draws:
    """The seeded conditions of one run; the posture ranges are drawn as they are needed.

    Attributes:
        human_start_s: when the human's script starts.
        connected: whether the human's signals reach the robot at all.
        timeout_time_s: the parameter of the legacy robot.
        poll_growth_s: how much each subscription slows a poll down.
        start_pose: joint angles after the reset, rad.
    """

    human_start_s: float
    connected: bool
    timeout_time_s: int
    poll_growth_s: float
    start_pose: Joints


def draw(seed: int, *, startup_loss: bool) -> Draws:
    """Draw the conditions of a run.

    Switching the loss off changes nothing else: its number is drawn all the same.
    """
    rng = stream(seed, "conditions")
    a, b, c = p.ZERO_POSE
    reach = p.START_POSE_RANGE
    return Draws(
        human_start_s=rng.uniform(*p.HUMAN_START_S),
        connected=rng.random() >= p.STARTUP_LOSS or not startup_loss,
        timeout_time_s=rng.randint(*p.TIMEOUT_TIME_S),
        poll_growth_s=rng.uniform(*p.POLL_GROWTH_S),
        start_pose=(
            a + rng.uniform(-reach, reach),
            b + rng.uniform(-reach, reach),
            c + rng.uniform(-reach, reach),
        ),
    )


def stream(seed: int, name: str) -> random.Random:
    """An independent random stream of a seed, the same in every process."""
    return random.Random(f"{name}/{seed}")  # noqa: S311  # repeatable, not secret
