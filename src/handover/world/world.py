"""The simulated world: time, physics and messages, advanced together."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import TYPE_CHECKING

from handover.robot.ports import Reading, Value
from handover.world import parameters as p
from handover.world.arm import Arm, Gripper
from handover.world.building import AS_PLANNED, build
from handover.world.bus import Bus, Schedule
from handover.world.faults import SceneFaults, SensorFaults
from handover.world.film import Film
from handover.world.human import Human
from handover.world.measures import seen_piece
from handover.world.recorder import Recorder, SampleValue, Truth
from handover.world.sensing import Sensors

if TYPE_CHECKING:
    from rvmon.report import tracks as shown

PERFECT = SensorFaults()

HUMAN_SIGNALS = "human_signals"
"""The topic whose messages are names of events, as text."""

CLOSINGS = ("grip_closed", "robot_gripper")
"""Topics whose messages are always recorded with a measurement of the hand's distance."""


class World:
    """Robot body, human body and bus in one timeline of integer nanoseconds.

    The physics is stepped while something moves; at rest, time jumps to the next scheduled call.

    Args:
        rng: draws the planner's latency, faults, and the noise of sensors.
        faults: faults of the sensors.
        scene_faults: faults of the scene.
        jump: `False` steps the physics at rest, too.
        films: record a frame at 10 Hz while something moves.
        observer: called with each complete sample.
    """

    def __init__(
        self,
        rng: random.Random,
        *,
        faults: SensorFaults = PERFECT,
        scene_faults: SceneFaults = AS_PLANNED,
        jump: bool = True,
        films: bool = False,
        observer: Callable[[int, dict[str, SampleValue]], None] | None = None,
    ) -> None:
        self.schedule = Schedule()
        self.bus = Bus(self.schedule)
        self.recorder = Recorder(observer)
        self.scene = build(p.ZERO_POSE, scene_faults)
        self.arm = Arm(self.scene, rng, self._wake, self._note, scene_faults.plan_failure)
        self.gripper = Gripper(self.scene, self._wake, self._note)
        self.human = Human(self.scene, self._wake, self._after)
        self.sensors = Sensors(self.scene, self.human, faults, rng)
        self._truth = Truth(self.scene, self.human)
        self._stepped = 0
        self._step = 0
        self._planned_until = 0
        self._at_rest = False
        self._jump = jump
        self._hand_seen: tuple[int, float | None] = (-1, None)
        self._hidden = scene_faults.hidden
        self._rng = rng
        self._film = Film(self.scene) if films else None
        self.bus.tap(self._record)
        self._wake(0.0)
        self.recorder.signal(0, "sensors_disturbed", faults != PERFECT)
        self.recorder.signal(0, "person_beside", scene_faults.beside_m is not None)
        self._watch()

    def run(self, horizon_ns: int) -> None:
        """Make all scheduled calls up to an instant (inclusive), and complete the last sample."""
        while (t_ns := self.schedule.next_ns()) is not None and t_ns <= horizon_ns:
            self._advance(t_ns)
            self.schedule.run_next()
        self._advance(horizon_ns)
        self.recorder.finish()

    def sense(self) -> Reading:
        """Read the robot's sensors and publish the reading.

        A sensor without a reading is published as false, and a dead one as unknown.
        """
        now = self.schedule.now_ns
        reading = self.sensors.read(now)
        for sensor in ("gaze", "pressure", "location"):
            dead = self.sensors.is_dead(sensor)
            value = None if dead else bool(getattr(reading, sensor))
            self.recorder.signal(now, f"{sensor}_ok", value)
        self._note("sensors_read")
        if None not in (reading.gaze, reading.pressure, reading.location):
            self.recorder.event(now, "fully_read")
        return reading

    def piece(self) -> tuple[float, float] | None:
        """The piece as the robot's camera sees it, (x, z) in metres; `None`: it is hidden."""
        if self._hidden > 0 and self._rng.random() < self._hidden:
            self._note("piece_hidden")
            return None
        self._note("piece_seen")
        return seen_piece(self.scene)

    def hand_distance(self) -> float | None:
        """The measured distance (m) between the mass centres of hand and gripper, if known."""
        self._note("hand_looked_for")
        return self._measure_hand(self.schedule.now_ns)

    @property
    def stepped_s(self) -> float:
        """Simulated seconds for which the physics was stepped."""
        return self._stepped * p.STEP_NS / p.NS

    def film(self) -> shown.Scene | None:
        """The scene over time; `None` without `films`."""
        return None if self._film is None else self._film.scene()

    def _advance(self, t_ns: int) -> None:
        """Bring the physics to the last step at or before an instant."""
        target = t_ns // p.STEP_NS
        while self._step < target:
            if self._at_rest and self._jump:
                self._step = target
                return
            if self._step % p.CONTROL_STEPS == 0:
                self.arm.control()
                self.gripper.control()
                self.human.control()
                self.sensors.remember(self._step * p.STEP_NS)
            self.scene.space.step(p.STEP_NS / p.NS)
            self._step += 1
            self._stepped += 1
            self._truth.step()
            if self._step % p.WATCH_STEPS == 0 and not self._at_rest:
                self._at_rest = self._step >= self._planned_until and self._is_still()
                self._watch()

    def _wake(self, seconds: float) -> None:
        """Expect the scene to move for some seconds."""
        now = self.schedule.now_ns // p.STEP_NS
        until = now + round((seconds + p.SETTLE_S) * p.NS) // p.STEP_NS
        self._planned_until = max(self._planned_until, until)
        self._at_rest = False

    def _after(self, seconds: float, call: Callable[[], None]) -> None:
        self.schedule.at(self.schedule.now_ns + round(seconds * p.NS), call)

    def _is_still(self) -> bool:
        scene = self.scene
        return all(
            body.velocity.length < p.REST_SPEED and abs(body.angular_velocity) < 10 * p.REST_SPEED
            for body in (scene.piece, scene.hand, scene.links[2], *scene.fingers)
        )

    def _watch(self) -> None:
        """Publish measurements, and record a frame."""
        t_ns = self._step * p.STEP_NS
        self._measure_hand(t_ns)
        self._measure_truth(t_ns)
        if self._film is not None:
            self._film.take(t_ns)

    def _measure_truth(self, t_ns: int) -> None:
        truth = self._truth.measure(t_ns)
        if self._at_rest:
            truth["tool_speed"] = 0.0
        for name, value in truth.items():
            self.recorder.signal(t_ns, name, value)

    def _note(self, name: str) -> None:
        """Record an event with the state of the scene at its instant."""
        now = self.schedule.now_ns
        self._measure_truth(now)
        for signal, value in self._truth.places().items():
            self.recorder.signal(now, signal, value)
        self.recorder.event(now, name)

    def _measure_hand(self, t_ns: int) -> float | None:
        """Publish the distance of the hand from the gripper, to 0.1 mm, once per instant."""
        seen_ns, distance = self._hand_seen
        if seen_ns == t_ns:
            return distance
        offset = self.sensors.hand_offset()
        x, z = (None, None) if offset is None else (round(offset[0], 4), round(offset[1], 4))
        distance = None if offset is None else round(math.hypot(*offset), 4)
        self.recorder.refresh(t_ns, "hand_distance", distance)
        self.recorder.signal(t_ns, "hand_offset_x", x)
        self.recorder.signal(t_ns, "hand_offset_z", z)
        self._hand_seen = (t_ns, distance)
        return distance

    def _record(self, topic: str, value: Value) -> None:
        now = self.schedule.now_ns
        if topic in CLOSINGS and value is not False:
            self._measure_hand(now)
        if value is None:
            if self.recorder.has(now, topic):
                self.recorder.event(now, "said_twice")
            self._note(topic)
        elif isinstance(value, str):
            if topic == HUMAN_SIGNALS:
                self.recorder.event(now, value)
        else:
            self.recorder.signal(now, topic, value)
