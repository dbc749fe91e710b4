"""What is so in the scene, whatever sensors and robot say of it."""

from __future__ import annotations

import math

from handover.world import parameters as p
from handover.world.human import Human
from handover.world.measures import (
    gaze_is_ok,
    gripper_force,
    gripper_opening,
    hand_offset,
    location_is_ok,
    tool_point,
    tool_speed,
)
from handover.world.recorder import SampleValue
from handover.world.scene import Scene


class Truth:
    """Measures the bodies without error, for requirements and people, never for the robot.

    Args:
        scene: where the bodies are.
        human: who may hold the piece.
    """

    def __init__(self, scene: Scene, human: Human) -> None:
        self._scene = scene
        self._human = human
        self._peak = 0.0
        self._shown = (-1, 0.0)

    def step(self) -> None:
        """Keep the greatest force on the hand between two measurements."""
        self._peak = max(self._peak, self._human.hand_force())

    def measure(self, t_ns: int) -> dict[str, SampleValue]:
        """All signals at an instant: lengths in m, to 1 mm, forces in N, speeds in m/s."""
        self.step()
        shown_ns, shown = self._shown
        peak = max(self._peak, shown if shown_ns == t_ns else 0.0)
        self._shown, self._peak = (t_ns, peak), 0.0
        scene = self._scene
        grip = gripper_force(scene)
        return {
            "piece_height": round(scene.piece.position.y, 3),
            "gripper_holds": grip >= p.PRESSURE_MIN,
            "person_holds": self._human.holds(),
            "gripper_opening": round(gripper_opening(scene), 3),
            "hand_force": round(peak),
            "true_distance": round(math.hypot(*hand_offset(scene)), 3),
            "true_gaze": gaze_is_ok(scene),
            "true_pressure": self._human.shares_piece(),
            "true_location": location_is_ok(scene),
            "tool_speed": round(tool_speed(scene), 3),
        }

    def places(self) -> dict[str, SampleValue]:
        """Where the piece is, and how far behind it and above it the grip is: m, to 1 mm."""
        piece, grip = self._scene.piece.position, tool_point(self._scene)
        return {
            "piece_x": round(piece.x, 3),
            "grip_behind": round(piece.x - grip[0], 3),
            "grip_above": round(grip[1] - piece.y, 3),
        }
