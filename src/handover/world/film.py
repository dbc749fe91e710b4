"""Keeps the scene over time, for an animation."""

from __future__ import annotations

import pymunk

from handover.world import parameters as p
from handover.world.building import palm_corners, table_corners
from handover.world.poses import Outline, Poses
from handover.world.scene import Scene

BODIES = (
    "upper_arm",
    "forearm",
    "palm",
    "left_finger",
    "right_finger",
    "piece",
    "hand",
    "head",
)


class Film:
    """Takes frames of a scene."""

    def __init__(self, scene: Scene) -> None:
        self._bodies = _bodies(scene)
        self._frames: list[tuple[int, tuple[float, ...]]] = []

    def take(self, t_ns: int) -> None:
        """Take a frame now, rounded to 0.1 mm and 0.1 mrad."""
        frame: list[float] = []
        for body in self._bodies:
            x, z = body.position
            frame += (round(x, 4), round(z, 4), round(body.angle, 4))
        self._frames.append((t_ns, tuple(frame)))

    def poses(self) -> Poses:
        """All frames, with what to draw."""
        return Poses(BODIES, outlines(), tuple(self._frames))


def outlines() -> tuple[Outline, ...]:
    """What to draw for each body of `BODIES`, and for the ground."""
    length, width = p.FINGER_LENGTH / 2, p.FINGER_THICKNESS / 2
    finger = ((-length, -width), (length, -width), (length, width), (-length, width))
    half_x, half_z = p.PIECE_SIZE[0] / 2, p.PIECE_SIZE[1] / 2
    return (
        Outline("upper_arm", ((-p.UPPER_ARM / 2, 0.0), (p.UPPER_ARM / 2, 0.0)), 0.03),
        Outline("forearm", ((-p.FOREARM / 2, 0.0), (p.FOREARM / 2, 0.0)), 0.025),
        Outline("palm", palm_corners()),
        Outline("left_finger", finger),
        Outline("right_finger", finger),
        Outline(
            "piece",
            ((-half_x, -half_z), (half_x, -half_z), (half_x, half_z), (-half_x, half_z)),
        ),
        Outline("hand", ((0.0, 0.0),), p.HAND_RADIUS),
        Outline("head", ((0.0, 0.0),), p.HEAD_RADIUS),
        Outline("ground", table_corners()),
        Outline("ground", ((-2.0, p.FLOOR_Z), (3.0, p.FLOOR_Z))),
    )


def _bodies(scene: Scene) -> tuple[pymunk.Body, ...]:
    """The bodies that have a pose, in the order of `BODIES`."""
    return (*scene.links, *scene.fingers, scene.piece, scene.hand, scene.head)
