"""The arm and the gripper with their commands: plan, follow, open, close."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from itertools import pairwise

from handover.world import parameters as p
from handover.world.measures import beside_distance
from handover.world.motion import Joints, Trajectory, between, grip_point, joints_for, min_jerk
from handover.world.scene import Scene


@dataclass(slots=True)
class Arm:
    """Plans and follows paths; it writes to its motors only when their command changes."""

    scene: Scene  # with the motors
    rng: random.Random  # draws the planner's latency and its failures
    wake: Callable[[float], None]  # called with the seconds for which the scene is going to move
    note: Callable[[str], None]  # called with the name of each command and of each failed plan
    plan_failure: float = 0.0  # probability that no path is found although the point is in reach
    _goal: Joints = field(init=False)
    _path: Trajectory | None = field(default=None, init=False)
    _path_s: float = field(default=0.0, init=False)
    _minds_people: bool = field(default=False, init=False)
    _stopped: bool = field(default=False, init=False)
    _rates: list[float] = field(default_factory=lambda: [0.0] * 3, init=False)

    def __post_init__(self) -> None:
        self._goal = self.joints()

    def joints(self) -> Joints:
        """The current joint angles, rad."""
        upper, fore, palm = self.scene.links
        first, second, third = upper.angle, fore.angle, palm.angle
        return first, second - first, third - second

    def plan(self, x: float, z: float) -> Generator[float, None, Trajectory | None]:
        """Find a path of the grip to a point (metres), gripper down and clear of people.

        It takes the planner's latency.

        Returns:
            The path, or `None` if there is none.
        """
        yield self.rng.uniform(*p.PLAN_LATENCY_S)
        goal = joints_for(x, z)
        fails = self.plan_failure > 0 and self.rng.random() < self.plan_failure
        path = None if goal is None or fails else self._path_to(goal)
        if path is None:
            self.note("plan_failed")
        return path

    def interpolate(self, joints: Joints, duration: float) -> Trajectory:
        """A path to joint angles (rad) with a given duration (s), without planning."""
        return Trajectory(self._start(), joints, duration)

    def follow(
        self, path: Trajectory, *, minds_people: bool = False
    ) -> Generator[float, None, bool]:
        """Move along a path; with `minds_people`, stop for good where a person is close.

        It returns after the duration of the path in any case.

        Returns:
            Whether the arm got to the end of the path.
        """
        self._path, self._path_s = path, 0.0
        self._goal = path.goal
        self._minds_people, self._stopped = minds_people, False
        self.note("arm_commanded")
        self.wake(path.duration)
        yield path.duration
        if self._stopped:
            self.note("arm_stopped")
        return not self._stopped

    def control(self) -> None:
        """Set the motors so that the next control step ends on the path."""
        path = self._path
        if (
            path is not None
            and self._minds_people
            and (beside_distance(self.scene, *grip_point(self.joints())) < p.CLEARANCE[1])
        ):
            self._goal, self._stopped = self.joints(), True
            path = self._path = None
        wanted = self._goal
        if path is not None:
            self._path_s += p.CONTROL_S
            wanted = between(path.start, path.goal, min_jerk(self._path_s / path.duration))
            if self._path_s >= path.duration:
                self._path = None
        for index, (motor, want, have) in enumerate(
            zip(self.scene.joint_motors, wanted, self.joints(), strict=True)
        ):
            error = want - have
            # A motor of pymunk turns its second body at minus `rate` relative to the first.
            rate = -error / p.CONTROL_S if abs(error) > 1e-6 else 0.0
            if rate != self._rates[index]:
                self._rates[index] = rate
                motor.rate = rate

    def _start(self) -> Joints:
        """The last goal of the arm, or its current joint angles while it is still moving."""
        return self._goal if self._path is None else self.joints()

    def _path_to(self, goal: Joints) -> Trajectory | None:
        start = self._start()
        steps = 40
        shares = (min_jerk(i / steps) for i in range(steps + 1))
        points = [grip_point(between(start, goal, share)) for share in shares]
        if any(beside_distance(self.scene, *point) < p.CLEARANCE[0] for point in points):
            return None
        fastest = max(math.dist(a, b) for a, b in pairwise(points)) * steps
        return Trajectory(start, goal, max(p.SHORTEST_MOTION_S, fastest / p.TOOL_SPEED_LIMIT))


class Gripper:
    """Two fingers that turn with limited torque until an object or their stop holds them."""

    def __init__(
        self, scene: Scene, wake: Callable[[float], None], note: Callable[[str], None]
    ) -> None:
        self._scene = scene
        self._wake = wake
        self._note = note
        self._rates = [0.0, 0.0]
        self._travel_s = (p.FINGER_OPEN - p.FINGER_OVERCLOSED) / p.FINGER_SPEED

    def open(self) -> None:
        """Start to open both fingers."""
        self._note("open_commanded")
        self._turn(-p.FINGER_SPEED)

    def close(self) -> None:
        """Start to close both fingers, which keep pressing."""
        self._note("close_commanded")
        self._turn(p.FINGER_SPEED)

    def control(self) -> None:
        """Stop the motor of a finger at its stop, as it would jerk the arm if it kept pressing."""
        if not any(self._rates):
            return
        palm = self._scene.links[2].angle
        for index, (finger, side) in enumerate(zip(self._scene.fingers, (1, -1), strict=True)):
            angle, closing = side * (finger.angle - palm), side * self._rates[index]
            if (closing < 0 and angle > p.FINGER_OPEN - p.AT_STOP) or (
                closing > 0 and angle < p.FINGER_OVERCLOSED + p.AT_STOP
            ):
                self._set(index, 0.0)

    def _turn(self, closing_speed: float) -> None:
        self._set(0, closing_speed)
        self._set(1, -closing_speed)
        self._wake(self._travel_s)

    def _set(self, index: int, rate: float) -> None:
        self._rates[index] = rate
        self._scene.finger_motors[index].rate = rate
