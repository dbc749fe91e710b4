"""What the robot senses and the human achieves comes from bodies and forces, not from flags."""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable
from dataclasses import dataclass, field

import pymunk
import pytest

from handover.robot.ports import Reading
from handover.world import parameters as p
from handover.world.bus import Node
from handover.world.faults import SceneFaults, SensorFaults
from handover.world.process import Process, Program
from handover.world.world import World

Point = tuple[float, float]
HANDOVER = (0.20, 0.22)


@dataclass
class Stage:
    """A world with one program that acts in it."""

    world: World = field(default_factory=lambda: World(random.Random(1)))
    notes: list[Point] = field(default_factory=list)
    readings: list[Reading] = field(default_factory=list)

    def play(self, program: Callable[[Stage], Program], seconds: float) -> None:
        process = Process(self.world.schedule, Node(self.world.bus, {}, 0.0), program(self))
        self.world.run(round(seconds * p.NS))
        assert process.error is None

    def go(self, x: float, z: float) -> Program:
        path = yield from self.world.arm.plan(x, z)
        assert path is not None
        yield from self.world.arm.follow(path)

    def fetch(self) -> Program:
        x, z = self.world.piece()
        for height in (0.20, 0.08, 0.02):
            yield from self.go(x, z + height)
        self.world.gripper.close()
        yield 0.5
        Node(self.world.bus, {}, 0.0).publish("grip_closed")
        yield from self.go(*HANDOVER)
        yield 0.5

    def offer(self) -> None:
        """The human does all that it takes to get the piece."""
        human = self.world.human
        human.look(0.15, 0.55, 20.0)
        human.grasp(closed=True)
        human.reach(*p.LOCATION_OK, near=True)

    def sense(self) -> None:
        self.readings.append(self.world.sense())

    @property
    def piece(self) -> Point:
        x, z = self.world.scene.piece.position
        return x, z

    @property
    def hand(self) -> Point:
        x, z = self.world.scene.hand.position
        return x, z


def steps(*what: float | Callable[[Stage], Program | None]) -> Callable[[Stage], Program]:
    """A program that waits so many seconds, or does what is named, one after the other."""

    def program(stage: Stage) -> Program:
        for one in what:
            if isinstance(one, float):
                yield one
            elif (made := one(stage)) is not None:
                yield from made

    return program


def close(stage: Stage) -> None:
    stage.world.gripper.close()


def let_go(stage: Stage) -> None:
    stage.world.gripper.open()


def note(stage: Stage) -> None:
    stage.notes.append(stage.piece)


def to(x: float, z: float) -> Callable[[Stage], Program]:
    return lambda stage: stage.go(x, z)


def strapped(newtons: float) -> Callable[[Stage], None]:
    """The hand is held back where it is."""

    def strap(stage: Stage) -> None:
        scene = stage.world.scene
        band = pymunk.PivotJoint(scene.space.static_body, scene.hand, scene.hand.position)
        band.max_force = newtons
        scene.space.add(band)

    return strap


def lift(stage: Stage) -> None:
    stage.world.scene.head.position += (0.0, 0.3)


def turn(stage: Stage) -> None:
    stage.world.scene.head.position -= (0.0, 0.3)
    stage.world.scene.head.angle -= 1.0


def release(stage: Stage) -> None:
    stage.world.human.grasp(closed=False)


HANDED = (Stage.fetch, Stage.offer, 2.0, Stage.sense)
OK = Reading(gaze=True, pressure=True, location=True)
EMPTY = Reading(gaze=True, pressure=False, location=True)
ELSEWHERE = Reading(gaze=False, pressure=True, location=True)
UNREAD = Reading(gaze=None, pressure=None, location=None)

READINGS = {
    "looking, reaching and holding make all true": (HANDED, [OK]),
    "a hand that is held back gives none": (
        (strapped(60.0), *HANDED),
        [Reading(gaze=True, pressure=None, location=None)],
    ),
    "its force is limited, not absent: it gets past a weaker strap": (
        (strapped(10.0), *HANDED),
        [OK],
    ),
    "the human alone holding the piece is no pressure: the robot must hold it, too": (
        (0.5, Stage.offer, 2.0, Stage.sense),
        [EMPTY],
    ),
    "a gripper that closed beside the piece is none": (
        (to(-0.15, 0.12), close, 0.5, Stage.offer, 2.0, Stage.sense),
        [EMPTY],
    ),
    "a body that is moved by hand changes them, though the human intends as before": (
        (*HANDED, lift, Stage.sense, turn, Stage.sense),
        [OK, ELSEWHERE, ELSEWHERE],
    ),
    "none comes of a human who takes no part, or whose hand and head still move": (
        (Stage.sense, Stage.offer, p.REACTION_S + 0.2, Stage.sense),
        [UNREAD, UNREAD],
    ),
    "who decides to let go still holds for the reaction time, then no longer": (
        (*HANDED, release, p.REACTION_S - 0.05, Stage.sense, 1.5, Stage.sense),
        [OK, OK, EMPTY],
    ),
}


@pytest.mark.parametrize("name", READINGS)
def test_readings_come_from_bodies(name: str) -> None:
    what, readings = READINGS[name]
    stage = Stage()
    stage.play(steps(*what), 25)
    assert stage.readings == readings


@pytest.mark.slow
def test_what_loses_each_reading_says_nothing_of_it() -> None:
    stage = Stage(World(random.Random(1), faults=SensorFaults(loss=1.0)))
    stage.play(steps(*HANDED), 25)
    assert stage.readings == [UNREAD]


def test_grasp_slips_when_it_is_overcome() -> None:
    """A hand that cannot follow loses the piece to the robot that pulls it away."""
    stage = Stage()
    stage.play(steps(*HANDED, strapped(500.0), to(0.05, 0.25), Stage.sense), 30)
    assert [reading.pressure for reading in stage.readings] == [True, False]
    assert stage.piece == pytest.approx((0.05, 0.23), abs=0.03)


def test_released_piece_stays_in_the_human_hand() -> None:
    stage = Stage()
    stage.play(steps(*HANDED, note, let_go), 30)
    assert stage.piece == pytest.approx(stage.notes[0], abs=0.02)


def test_unheld_piece_falls() -> None:
    """Past the table's edge to the floor."""
    stage = Stage()
    stage.play(steps(Stage.fetch, note, let_go), 25)
    assert stage.notes[0][1] == pytest.approx(HANDOVER[1] - 0.02, abs=0.01)
    assert stage.piece[1] < p.FLOOR_Z + p.PIECE_SIZE[1]


@pytest.mark.slow
def test_gripped_piece_stays_where_it_is() -> None:
    """A held piece does not creep: within 0.1 mm over 20 s, stepped throughout."""
    stage = Stage(World(random.Random(1), jump=False))
    stage.play(steps(Stage.fetch, note, 20.0, note), 45)
    assert stage.notes[1] == pytest.approx(stage.notes[0], abs=1e-4)


def test_hand_reacts_late_and_moves_smoothly() -> None:
    """The hand rests for the reaction time, never jumps, and is fastest in mid-way."""
    stage = Stage()
    tick = 0.02

    def program(stage: Stage) -> Program:
        stage.world.human.reach(*p.LOCATION_OK, near=True)
        for _ in range(75):
            stage.notes.append(stage.hand)
            yield tick

    stage.play(program, 2)
    xs = [x for x, _ in stage.notes]
    reaction = round(p.REACTION_S / tick)
    assert xs[: reaction + 1] == pytest.approx([p.HAND_REST[0]] * (reaction + 1), abs=1e-3)
    speeds = [abs(b - a) / tick for a, b in itertools.pairwise(xs)]
    assert max(speeds) <= p.REACH_SPEED * 1.1
    moving = [i for i, speed in enumerate(speeds) if speed > 0.01]
    fastest = speeds.index(max(speeds))
    assert fastest - moving[0] == pytest.approx(moving[-1] - fastest, abs=4)
    goal = (p.PIECE_X + p.LOCATION_OK[0], p.HAND_RADIUS)
    assert stage.hand == pytest.approx(goal, abs=0.01)


def test_redirected_hand_does_not_jump() -> None:
    """A hand that is sent elsewhere in mid-way turns without a jump of its place or speed."""
    stage = Stage()
    tick = 0.02

    def program(stage: Stage) -> Program:
        stage.world.human.reach(*p.LOCATION_OK, near=True)
        yield 0.25
        stage.world.human.reach(0.8, 0.8, near=False)
        for _ in range(90):
            stage.notes.append(stage.hand)
            yield tick

    stage.play(program, 3)
    xs = [x for x, _ in stage.notes]
    speeds = [(b - a) / tick for a, b in itertools.pairwise(xs)]
    jumps = [abs(b - a) for a, b in itertools.pairwise(speeds)]
    assert min(xs) < p.HAND_REST[0] - 0.05
    assert max(jumps) < 0.5
    assert stage.hand == pytest.approx((p.PIECE_X + 0.8, p.PIECE_SIZE[1] / 2 + 0.8), abs=0.01)


def test_withdrawing_ends_all_readings() -> None:
    """The person who loses interest lets go, and is seen no more at the chest."""
    stage = Stage()
    stage.play(steps(*HANDED, lambda stage: stage.world.human.withdraw(), 2.0, Stage.sense), 25)
    assert stage.readings[1] == UNREAD
    assert stage.hand == pytest.approx(p.HAND_REST, abs=0.01)
    assert stage.piece == pytest.approx((HANDOVER[0], HANDOVER[1] - 0.02), abs=0.02)


def test_arm_follows_paths_below_the_speed_limit() -> None:
    """The tool arrives where it was sent, and is never faster than collaborative operation."""
    stage = Stage()
    stage.play(Stage.fetch, 25)
    speeds = [
        values["tool_speed"] for _, values in stage.world.recorder.samples if "tool_speed" in values
    ]
    assert 0.2 < max(speeds) <= 0.25
    assert speeds[-1] == 0.0
    assert stage.world.arm.joints() == pytest.approx(joints_at(*HANDOVER), abs=1e-3)


def joints_at(x: float, z: float) -> tuple[float, float, float]:
    from handover.world.motion import joints_for

    joints = joints_for(x, z)
    assert joints is not None
    return joints


@pytest.mark.slow
@pytest.mark.parametrize(("in_plane", "feels_it"), [(True, True), (False, False)])
def test_the_gripper_pushes_a_hand_in_its_plane_alone(*, in_plane: bool, feels_it: bool) -> None:
    """A hand on the table where the gripper comes down is hit, one in front of it is passed."""
    stage = Stage(World(random.Random(1), scene_faults=SceneFaults(hand_in_plane=in_plane)))

    def reach(stage: Stage) -> None:
        stage.world.human.reach(*p.LOCATION_OK, near=True)

    stage.play(steps(reach, 1.5, to(p.LOCATION_OK[0] + 0.07, 0.05)), 10)
    forces = [v["hand_force"] for _, v in stage.world.recorder.samples if "hand_force" in v]
    assert (max(force or 0.0 for force in forces) > 10) is feels_it
