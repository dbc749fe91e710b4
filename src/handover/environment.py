"""The handover as a Gymnasium environment, `rvmon/Handover-v0`; needs the extra `gym`.

Importing this module registers the environment, as is usual for Gymnasium; `gymnasium.make(
"handover.environment:rvmon/Handover-v0")` does both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, cast

import gymnasium
import numpy as np
from numpy.typing import NDArray

from handover.driver.play import Played, set_up
from handover.generator.abstract_test import AbstractTest, Action, SendSignal, SetParam, Withdraw
from handover.world.measures import gripper_centre
from handover.world.recorder import Sample
from rvmon.trace.time import TICKS_PER_SECOND

if TYPE_CHECKING:
    from rvmon.session import Spec

STEP_S = 0.1
"""Seconds per step, the period at which the world publishes the position of the hand."""

HORIZON_S = 200.0

ACTIONS: Mapping[str, Action | None] = {
    "nothing": None,
    "activate the robot": SendSignal("activateRobot"),
    "say that one is ready": SendSignal("humanIsReady"),
    "look at the piece": SetParam("hgazeOk", 1),
    "look past it": SetParam("hgazeOk", 0),
    "reach for the piece": SetParam("hlocationOk", 1),
    "reach past it": SetParam("hlocationOk", 0),
    "close the hand": SetParam("hpressureOk", 1),
    "open the hand": SetParam("hpressureOk", 0),
    "withdraw": Withdraw(),
}
"""The actions of the person, by name; an action of the environment is the index of an entry."""

OBSERVED: Mapping[str, tuple[float, float]] = {
    "seconds since the start": (0.0, HORIZON_S),
    "whether the robot has said that the piece can be taken": (0.0, 1.0),
    "x of the gripper [m]": (-2.0, 2.0),
    "z of the gripper [m]": (-2.0, 2.0),
    "x of the piece [m]": (-2.0, 2.0),
    "z of the piece [m]": (-2.0, 2.0),
    "x of the hand [m]": (-2.0, 2.0),
    "z of the hand [m]": (-2.0, 2.0),
    "whether the hand holds the piece": (0.0, 1.0),
}
"""The entries of an observation, in order, each with its smallest and largest value."""

_WAIT = SetParam("time", round(STEP_S / 0.05))
_STEP_NS = round(STEP_S * TICKS_PER_SECOND)
_HORIZON_STEPS = round(HORIZON_S / STEP_S)


class HandoverEnv(gymnasium.Env[NDArray[np.float32], np.int64]):
    """A robot hands an object over to a person, who is the agent.

    The robot and the world are those of the testbench. The reward is 1 in the step in which the
    robot releases the piece. An episode is terminated when the robot has ended or crashed, and
    truncated after 200 s. The seed of `reset` and the actions determine the episode.

    The person comes after 3 to 5.5 s and does one thing at a time; sending a signal takes 2.2 s. An
    action given meanwhile is not started, and `info["begun"]` is then false. `info["samples"]` has
    what was published in the step, as in a recording: instants in ns, values by name.

    Args:
        robot: `"correct"` or `"legacy"`.
        mutation: a name from `handover.robot.mutants.MUTATIONS`, for a robot with a planted fault.

    Raises:
        TestError: from `reset`, if there is no robot or mutation of that name.
    """

    def __init__(self, *, robot: str = "correct", mutation: str | None = None) -> None:
        low, high = zip(*OBSERVED.values(), strict=True)
        self.observation_space = gymnasium.spaces.Box(
            np.array(low, np.float32), np.array(high, np.float32)
        )
        self.action_space = gymnasium.spaces.Discrete(len(ACTIONS))
        self._robot, self._mutation = robot, mutation
        self._played: Played | None = None

    def reset(
        self,
        *,
        seed: int | None = None,
        options: dict[str, Any] | None = None,  # noqa: ARG002 - Gymnasium has it so
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start an episode."""
        super().reset(seed=seed)
        self._seed = int(self.np_random.integers(2**31)) if seed is None else seed
        self._chosen: Action | None = None
        self._done: list[Action] = []
        self._steps = 0
        self._reported = 0
        self._informed = False
        self._played = set_up(
            self.test, actions=self._acts(), robot=self._robot, mutation=self._mutation
        )
        return self._observed(self._played), {"samples": (), "begun": False}

    def _acts(self) -> Iterator[Action]:
        """The person's actions: the chosen one if there is any, then a wait of one step."""
        while True:
            for action in (self._chosen, _WAIT):
                if action is not None:
                    self._chosen = None
                    self._done.append(action)
                    yield action

    def step(
        self, action: np.int64
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Start an action and let 0.1 s pass.

        Raises:
            ResetNeeded: `reset` was not called before.
            InvalidAction: there is no such action.
        """
        if self._played is None:
            raise gymnasium.error.ResetNeeded("call `reset` before the first step")
        if not self.action_space.contains(action):
            raise gymnasium.error.InvalidAction(f"{action!r}: expected 0 to {len(ACTIONS) - 1}")
        self._chosen = chosen = tuple(ACTIONS.values())[action]
        self._steps += 1
        world = self._played.world
        world.run(self._steps * _STEP_NS - 1)  # the end instant itself belongs to the next step
        samples = world.recorder.samples[self._reported :]
        self._reported += len(samples)
        happened = {name for _, values in samples for name in values}
        self._informed |= "informed" in happened
        robot = self._played.process
        info = {
            "samples": tuple(samples),
            "begun": chosen is not None and self._chosen is None,
            "error": robot.error,
        }
        reward, truncated = float("released" in happened), self._steps >= _HORIZON_STEPS
        return self._observed(self._played), reward, robot.is_over, truncated, info

    @property
    def test(self) -> AbstractTest:
        """The episode so far as a test, which `handover replay` can play up to this instant."""
        return AbstractTest(
            name="episode",
            strategy="directed",
            seed=self._seed,
            actions=tuple(self._done),
            horizon_s=(max(self._steps, 1) * _STEP_NS - 1) / TICKS_PER_SECOND,
            startup_loss=False,
        )

    def _observed(self, played: Played) -> NDArray[np.float32]:
        scene = played.world.scene
        places = (gripper_centre(scene), scene.piece.position, scene.hand.position)
        seen = (
            self._steps * STEP_S,
            self._informed,
            *(metres for x, z in places for metres in (x, z)),
            played.world.human.holds(),
        )
        space = cast("gymnasium.spaces.Box", self.observation_space)
        return np.clip(np.array(seen, np.float32), space.low, space.high)


def published(spec: Spec) -> Callable[[object, object, Mapping[str, Any]], list[Sample]]:
    """Make the `observe` function of `rvmon.adapters.gym.Judged` for a specification.

    It returns the samples of a step, with only the names that the specification declares.
    """
    declared = {*spec.schema.signals, *spec.schema.events}

    def observe(_: object, __: object, info: Mapping[str, Any]) -> list[Sample]:
        return [
            (t, {name: value for name, value in values.items() if name in declared})
            for t, values in info["samples"]
        ]

    return observe


gymnasium.register("rvmon/Handover-v0", f"{__name__}:{HandoverEnv.__name__}")
