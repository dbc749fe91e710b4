"""Plain measurements on the bodies of the scene."""

from __future__ import annotations

import pymunk

from handover.world import parameters as p
from handover.world.scene import Scene


def contact_force(body: pymunk.Body, other: pymunk.Body) -> float:
    """N between two bodies in the last physics step, by contact alone; 0 if they do not touch."""
    impulses: list[float] = []

    def collect(arbiter: pymunk.Arbiter) -> None:
        if other in arbiter.bodies:
            impulses.append(arbiter.total_impulse.length)

    body.each_arbiter(collect)
    return sum(impulses) / (p.STEP_NS / p.NS)


def seen_piece(scene: Scene) -> tuple[float, float]:
    """Where camera and eyes see the piece, (x, z) in metres."""
    x, z = scene.piece.position
    return round(x, p.SIGHT_RESOLUTION_DIGITS), round(z, p.SIGHT_RESOLUTION_DIGITS)


def hand_offset(scene: Scene) -> tuple[float, float]:
    """Metres between the mass centres of hand and gripper on each axis, without sign."""
    x, z = gripper_centre(scene)
    hand = scene.hand.position
    return abs(hand.x - x), abs(hand.y - z)


def tool_speed(scene: Scene) -> float:
    """Metres per second of the point between the pads."""
    between_pads = (p.WRIST_TO_GRIP - p.PALM_LENGTH / 2, 0.0)
    return float(scene.links[2].velocity_at_local_point(between_pads).length)


def gripper_centre(scene: Scene) -> tuple[float, float]:
    """The mass centre of palm and fingers, (x, z) in metres."""
    parts = (scene.links[2], *scene.fingers)
    mass = sum(part.mass for part in parts)
    x = sum(part.mass * part.position.x for part in parts) / mass
    z = sum(part.mass * part.position.y for part in parts) / mass
    return x, z
