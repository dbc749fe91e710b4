"""What the robot's sensors make of the bodies in the scene."""

from __future__ import annotations

import random
from collections import deque

from handover.world import parameters as p
from handover.world.faults import SensorFaults
from handover.world.human import Human
from handover.world.measures import gaze_is_ok, hand_offset, location_is_ok
from handover.world.reading import Reading
from handover.world.scene import Scene


class Sensors:
    """Gaze, pressure, location and the distance of the hand, measured on the bodies.

    Args:
        scene: where the bodies are.
        human: whose head and hand are tracked.
        faults: what is wrong with the sensors.
        rng: draws the noise.
    """

    def __init__(
        self, scene: Scene, human: Human, faults: SensorFaults, rng: random.Random
    ) -> None:
        self._scene = scene
        self._human = human
        self._faults = faults
        self._rng = rng
        self._delay_ns = round(faults.delay_s * p.NS)
        self._past: deque[tuple[int, Reading]] = deque()

    def remember(self, t_ns: int) -> None:
        """Keep the reading of this instant, if the sensors are slow."""
        if self._delay_ns:
            self._past.append((t_ns, self._read()))

    def read(self, t_ns: int) -> Reading:
        """Read gaze, pressure and location.

        A sensor has a reading once the human has begun to take part in its respect, and not
        while the tracked head or hand is moving. The value comes from the bodies alone.

        Args:
            t_ns: the instant of the reading.
        """
        if not self._delay_ns:
            return self._read()
        while len(self._past) > 1 and self._past[1][0] <= t_ns - self._delay_ns:
            self._past.popleft()
        if self._past and self._past[0][0] <= t_ns - self._delay_ns:
            return self._past[0][1]
        return Reading(gaze=None, pressure=None, location=None)

    def hand_offset(self) -> tuple[float, float] | None:
        """Metres between the mass centres of hand and gripper on each axis; `None`: unknown."""
        if self.is_dead("distance"):
            return None
        x, z = hand_offset(self._scene)
        return abs(x + self._noise()), abs(z + self._noise())

    def is_dead(self, sensor: str) -> bool:
        """Whether a sensor drops out."""
        return sensor in self._faults.dropout

    def _read(self) -> Reading:
        head_moves, hand_moves = self._human.is_moving()
        human = self._human
        gaze_known = human.gaze_taken_up and not head_moves and not self.is_dead("gaze")
        hand_known = human.location_taken_up and not hand_moves and not self.is_dead("location")
        force_known = human.pressure_taken_up and not hand_moves and not self.is_dead("pressure")
        return Reading(
            gaze=gaze_is_ok(self._scene, self._noise) if gaze_known else None,
            pressure=self._human.shares_piece() if force_known else None,
            location=location_is_ok(self._scene, self._noise) if hand_known else None,
        )

    def _noise(self) -> float:
        sd = self._faults.noise_m
        return self._rng.gauss(0.0, sd) if sd else 0.0
