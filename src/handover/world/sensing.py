"""The robot's sensors, which measure the bodies in the scene."""

from __future__ import annotations

import random
from collections import deque
from dataclasses import dataclass, field

from handover.robot.ports import Reading
from handover.world import measures
from handover.world import parameters as p
from handover.world.faults import SensorFaults
from handover.world.human import Human
from handover.world.scene import Scene


@dataclass(slots=True)
class Sensors:
    """Gaze, pressure, location and the distance of the hand, measured on the bodies."""

    scene: Scene  # with the bodies
    human: Human  # whose head and hand are tracked
    faults: SensorFaults
    rng: random.Random  # draws the noise
    _past: deque[tuple[int, Reading]] = field(default_factory=deque, init=False)

    @property
    def _delay_ns(self) -> int:
        return round(self.faults.delay_s * p.NS)

    def remember(self, t_ns: int) -> None:
        """Store the reading of this instant, if the sensors have a delay."""
        if self._delay_ns:
            self._past.append((t_ns, self._read()))

    def read(self, t_ns: int) -> Reading:
        """Read gaze, pressure and location.

        A sensor has a reading while the tracked head or hand is in view and still: a face that is
        turned away, or a hand at the chest, is not seen. Pressure has a reading only once the hand
        has been told to close or open.
        """
        if not self._delay_ns:
            return self._read()
        while len(self._past) > 1 and self._past[1][0] <= t_ns - self._delay_ns:
            self._past.popleft()
        if self._past and self._past[0][0] <= t_ns - self._delay_ns:
            return self._past[0][1]
        return Reading(gaze=None, pressure=None, location=None)

    def hand_offset(self) -> tuple[float, float] | None:
        """The measured distance (m) of hand and gripper on each axis; `None`: unknown."""
        if self.is_dead("distance"):
            return None
        x, z = measures.hand_offset(self.scene)
        return abs(x + self._noise()), abs(z + self._noise())

    def is_dead(self, sensor: str) -> bool:
        """Whether a sensor never gives a reading."""
        return sensor in self.faults.dropout

    def _read(self) -> Reading:
        head_moves, hand_moves = self.human.is_moving()
        head_known = measures.face_is_seen(self.scene) and not head_moves
        hand_known = measures.hand_is_seen(self.scene) and not hand_moves
        force_known = hand_known and not self.human.hand_is_slack
        return Reading(
            gaze=measures.gaze_is_ok(self.scene, self._noise)
            if self._reads("gaze", head_known)
            else None,
            pressure=self.human.shares_piece() if self._reads("pressure", force_known) else None,
            location=measures.location_is_ok(self.scene, self._noise)
            if self._reads("location", hand_known)
            else None,
        )

    def _reads(self, sensor: str, known: bool) -> bool:
        """Whether a sensor gives a reading, given whether its quantity can be observed."""
        if not known or self.is_dead(sensor):
            return False
        return not self.faults.loss or self.rng.random() >= self.faults.loss

    def _noise(self) -> float:
        sd = self.faults.noise_m
        return self.rng.gauss(0.0, sd) if sd else 0.0
