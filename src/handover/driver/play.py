"""Play one abstract test: robot, human and world from the test's seed to its horizon."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from handover.driver.run import AroundRobotStep, Observer, Run
    from handover.generator.abstract_test import AbstractTest


def run_test(
    test: AbstractTest,
    *,
    robot: str | None = None,
    mutation: str | None = None,
    startup_loss: bool = True,
    jump: bool = True,
    record_poses: bool = False,
    observer: Observer | None = None,
    around_robot_step: AroundRobotStep | None = None,
) -> Run:
    """Simulate a test and return all that was published.

    Args:
        test: what the human does, and the seed of everything random.
        robot: `"correct"` or `"legacy"`; default: the robot that the test names, else correct.
        mutation: default: the one that the test names.
        startup_loss: `False` switches the fitted loss of the first signal off in any case.
        jump: skip the physics while nothing moves; `False` steps all of it.
        record_poses: keep the scene over time for an animation.
        observer: called with each whole sample, in time order.
        around_robot_step: context in which each step of the robot's code runs.

    Raises:
        ValueError: no robot, mutation or sensor fault of that name.
    """
    raise NotImplementedError
