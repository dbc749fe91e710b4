"""Play an abstract test with robot, human and world, from its start to its horizon."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from handover.world import parameters as p
from handover.world.motion import Joints
from rvmon.cdv import TestError
from rvmon.trace.time import TICKS_PER_SECOND

if TYPE_CHECKING:
    from collections.abc import Iterable

    from handover.generator.abstract_test import AbstractTest, Action
    from handover.world.process import Process
    from handover.world.world import World
    from rvmon.report.tracks import Scene


@dataclass(frozen=True, slots=True)
class Conditions:
    """The random conditions of a run; postures are drawn later, when they are needed."""

    human_start_s: float  # the instant at which the human's script starts
    connected: bool  # whether the human's signals reach the robot at all
    timeout_time_s: int  # the parameter of the legacy robot
    poll_growth_s: float  # the delay that each left-over subscription adds to a poll
    start_pose: Joints  # joint angles after the reset, rad


def draw(seed: int, *, startup_loss: bool) -> Conditions:
    """Draw the conditions of a run.

    Switching the loss off changes nothing else, as its random number is drawn in any case.
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


SampleValue = bool | float | None
SampleValues = Mapping[str, SampleValue]

Observer = Callable[[int, SampleValues], None]
"""Called with each complete sample `(t_ns, values)` once simulated time has passed it."""

AroundRobotStep = Callable[[], AbstractContextManager[object]]
"""Makes the context in which one step of the robot's code runs (for statement coverage)."""


@dataclass(frozen=True, slots=True)
class Run:
    """A simulated test that is not judged yet."""

    # `(t_ns, values)` in strictly increasing order, with changed signals and events only. An event
    # is `True`, an unknown signal `None`; distances are in m, speeds in m/s.
    samples: tuple[tuple[int, SampleValues], ...]
    # `(t_ns, state)` for each entry of a robot state, re-entries (polls) included.
    states: tuple[tuple[int, str], ...]
    end_ns: int  # the horizon
    stepped_s: float  # simulated seconds for which the physics was stepped
    error: str | None  # the exception of the robot's code as text, if it crashed
    scene: Scene | None  # the scene over time, if requested


def run_test(test: AbstractTest, **options: Any) -> Run:
    """Simulate a test and return everything that was published.

    The same test gives the same run in every process, whatever was run before.

    Args:
        test: the actions of the human, and the seed of everything random.
        **options: as for `set_up`.

    Raises:
        TestError: there is no robot or mutation of that name.
    """
    played = set_up(test, **options)
    horizon_ns = round(test.horizon_s * TICKS_PER_SECOND)
    played.world.run(horizon_ns)
    return Run(
        samples=tuple(played.world.recorder.samples),
        states=tuple(played.states),
        end_ns=horizon_ns,
        stepped_s=played.world.stepped_s,
        error=played.process.error,
        scene=played.world.film(),
    )


@dataclass(frozen=True, slots=True)
class Played:
    """A test that is being played."""

    world: World  # runs the test up to an instant
    process: Process  # the robot's process
    states: list[tuple[int, str]]  # `(t_ns, state)` for each entry of a robot state so far


def set_up(
    test: AbstractTest,
    *,
    actions: Iterable[Action] | None = None,
    robot: str | None = None,
    mutation: str | None = None,
    startup_loss: bool = True,
    jump: bool = True,
    films: bool = False,
    observer: Observer | None = None,
    around_robot_step: AroundRobotStep | None = None,
) -> Played:
    """Set up robot, human and world of a test, without running them.

    Args:
        test: the actions of the human, and the seed of everything random.
        actions: actions of the human in place of those of the test; the next one is taken from the
            iterable when the previous one is over.
        robot: `"correct"` or `"legacy"`; default: the robot that the test names, else correct.
        mutation: name of a planted fault; default: the one that the test names.
        startup_loss: `False` switches off the fitted loss of signals to the legacy robot; the
            correct robot loses none.
        jump: skip the physics while nothing moves; `False` steps all of it.
        films: keep the scene over time for an animation.
        observer: called with each complete sample, in time order.
        around_robot_step: context in which each step of the robot's code runs.

    Raises:
        TestError: there is no robot or mutation of that name.
    """
    # Imported here, as the physics engine takes a tenth of a second to load.
    from handover.driver.script import Script
    from handover.robot.behaviour import BEHAVIOURS
    from handover.robot.handover import HandoverRobot
    from handover.robot.mutants import MUTATIONS
    from handover.world.bus import Node
    from handover.world.parameters import ZERO_POSE
    from handover.world.process import Process
    from handover.world.world import World

    robot = robot or test.robot or "correct"
    mutation = mutation or test.mutation
    if robot not in BEHAVIOURS:
        raise TestError(f"no robot named {robot!r}: there are {', '.join(BEHAVIOURS)}")
    if mutation is not None and mutation not in MUTATIONS:
        raise TestError(f"no mutation named {mutation!r}: there are {', '.join(MUTATIONS)}")
    make_robot = HandoverRobot if mutation is None else MUTATIONS[mutation]

    draws = draw(test.seed, startup_loss=startup_loss and test.startup_loss and robot == "legacy")
    world = World(
        stream(test.seed, "world"),
        faults=test.faults,
        scene_faults=test.scene,
        jump=jump,
        films=films,
        observer=observer,
    )
    states: list[tuple[int, str]] = []

    def note_state(topic: str, value: object) -> None:
        if topic == "robot_state":
            states.append((world.schedule.now_ns, str(value)))

    world.bus.tap(note_state)
    params = {
        "zero_pose": ZERO_POSE,
        "start_pose": draws.start_pose,
        "timeout_time": draws.timeout_time_s,
    }
    robot_node = Node(world.bus, params, draws.poll_growth_s)
    human_node = Node(world.bus, {}, draws.poll_growth_s)
    machine = make_robot(robot_node, world.arm, world.gripper, world, BEHAVIOURS[robot])
    rng = stream(test.seed, "postures")
    at_limits = test.postures == "at_limits"
    script = Script(
        test.actions if actions is None else actions,
        human_node,
        world.human,
        (lambda *limits: rng.choice(limits)) if at_limits else rng.uniform,
        start_s=draws.human_start_s if test.arrives_s is None else test.arrives_s,
        connected=draws.connected,
    )
    process = Process(world.schedule, robot_node, machine.run(), around_robot_step or nullcontext)
    Process(world.schedule, human_node, script.run())
    return Played(world, process, states)
