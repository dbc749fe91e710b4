"""Everything that a run leaves to chance, drawn once from the test's seed."""

from __future__ import annotations

import random

from handover.driver.conditions import Conditions
from handover.world import parameters as p


def draw(seed: int, *, startup_loss: bool) -> Conditions:
    """Draw the conditions of a run.

    Switching the loss off changes nothing else: its number is drawn all the same.
    """
    rng = stream(seed, "conditions")
    a, b, c = p.ZERO_POSE
    reach = p.START_POSE_RANGE
    return Conditions(
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
