"""Learn when a person has to reach so that the gripper closes on the hand."""

import random
import sys
from pathlib import Path

import gymnasium

import rvmon
from handover.environment import ACTIONS, STEP_S, published
from rvmon.adapters.gym import Judged
from rvmon.cdv.test import to_json

SPEC = rvmon.load(Path(__file__).parent / "grip.rv")
NUMBERS = {name: number for number, name in enumerate(ACTIONS)}
SEED, EPISODES, ACTIVATE, FIRST, LAST = 4, 100, 100, 130, 300


def play(env, reach):
    """Play an episode in which the person reaches at a step; return its reward and R5's verdict."""
    plan = {ACTIVATE: "activate the robot"}
    plan |= {reach: "reach for the piece", reach + 1: "close the hand"}
    env.reset(seed=SEED)
    total, over, step = 0.0, False, 0
    while not over:
        action = NUMBERS[plan.get(step, "nothing")]
        _, reward, terminated, truncated, info = env.step(action)
        total, step = total + reward, step + 1
        over = terminated or truncated or step == LAST
    return total, info["rv"]["verdicts"]["R5"]


def main():
    env = Judged(
        gymnasium.make("rvmon/Handover-v0"),
        SPEC,
        published(SPEC),
        step_s=STEP_S,
        ends_on_failure=True,
        shaping=lambda figures: sum(1 - one.robustness.high for one in figures),
    )
    rng = random.Random(SEED)
    best, best_reach = -1.0, FIRST
    for episode in range(1, EPISODES + 1):
        near, anywhere = rng.gauss(best_reach, 3), rng.uniform(FIRST, LAST)
        reach = min(max(round(rng.choice((near, anywhere))), FIRST), LAST)
        reward, verdict = play(env, reach)
        if reward > best:
            best, best_reach = reward, reach
            progress = f"episode {episode}: reaches after {reach * STEP_S:.1f} s,"
            print(progress, f"reward {reward:.3f}, R5 {verdict}")
        if verdict == "F":
            Path(sys.argv[1]).write_bytes(to_json(env.unwrapped.test))
            return


if __name__ == "__main__":
    main()
