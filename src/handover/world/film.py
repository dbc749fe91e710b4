"""Record the scene over time, for an animation."""

from __future__ import annotations

import math

from handover.world import parameters as p
from handover.world.building import box_corners, table_corners
from handover.world.scene import Scene
from rvmon.report import tracks as shown

BODIES = ("upper_arm", "forearm", "palm", "left_finger", "right_finger", "piece", "hand", "head")
BESIDE = ("lower_arm", "other_hand")
"""Additional bodies of a person beside the robot's way."""

VIEW = (-0.62, -0.1, 1.18, 0.95)
"""The visible area, metres: from behind the robot's shoulder to behind the human's head."""

GAZE_LENGTH = 0.55
GAZE_HALF_ANGLE = math.radians(12)


class Film:
    """Records frames of a scene."""

    def __init__(self, scene: Scene) -> None:
        # In the order of `BODIES` and `BESIDE`.
        arms = scene.arms
        more = () if arms is None else (arms.forearm, arms.other_hand)
        self._bodies = (*scene.links, *scene.fingers, scene.piece, scene.hand, scene.head, *more)
        self._frames: list[tuple[int, tuple[float, ...]]] = []

    def take(self, t_ns: int) -> None:
        """Record a frame, rounded to 0.1 mm and 0.1 mrad."""
        frame: list[float] = []
        for body in self._bodies:
            x, z = body.position
            frame += (round(x, 4), round(z, 4), round(body.angle, 4))
        self._frames.append((t_ns, tuple(frame)))

    def scene(self) -> shown.Scene:
        """All frames, with the shapes to draw."""
        bodies = (*BODIES, *BESIDE)[: len(self._bodies)]
        drawn = tuple(
            outline
            for outline in outlines()
            if outline.body not in BESIDE or outline.body in bodies
        )
        return shown.Scene(bodies, drawn, tuple(self._frames), VIEW)


def outlines() -> tuple[shown.Outline, ...]:
    """The outlines of each body, the ground, and the cone of the human's gaze."""
    half = (p.LOWER_ARM[1] - p.LOWER_ARM[0]) / 2 - p.LOWER_ARM_RADIUS
    finger = box_corners(p.FINGER_LENGTH, p.FINGER_THICKNESS)
    x, z = GAZE_LENGTH, GAZE_LENGTH * math.tan(GAZE_HALF_ANGLE)
    return (
        shown.Outline("upper_arm", ((-p.UPPER_ARM / 2, 0.0), (p.UPPER_ARM / 2, 0.0)), 0.03, "link"),
        shown.Outline("forearm", ((-p.FOREARM / 2, 0.0), (p.FOREARM / 2, 0.0)), 0.025, "link"),
        shown.Outline("palm", box_corners(p.PALM_LENGTH, p.PALM_WIDTH), 0.0, "gripper"),
        shown.Outline("left_finger", finger, 0.0, "gripper"),
        shown.Outline("right_finger", finger, 0.0, "gripper"),
        shown.Outline("piece", box_corners(*p.PIECE_SIZE), 0.0, "piece"),
        shown.Outline("hand", ((0.0, 0.0),), p.HAND_RADIUS, "person"),
        shown.Outline("lower_arm", ((-half, 0.0), (half, 0.0)), p.LOWER_ARM_RADIUS, "person"),
        shown.Outline("other_hand", ((0.0, 0.0),), p.HAND_RADIUS, "person"),
        shown.Outline("head", ((0.0, 0.0),), p.HEAD_RADIUS, "person"),
        shown.Outline("ground", table_corners(), 0.0, "ground"),
        shown.Outline("ground", ((-2.0, p.FLOOR_Z), (3.0, p.FLOOR_Z)), 0.0, "ground"),
        shown.Outline("head", ((0.0, 0.0), (x, -z), (x, z)), 0.0, "gaze"),
    )
