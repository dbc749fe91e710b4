"""What the robot's sensors make of the bodies in the scene."""

from __future__ import annotations

import math
from dataclasses import dataclass

from handover.world import parameters as p
from handover.world.contacts import contact_force
from handover.world.human import Human
from handover.world.scene import Scene


@dataclass(frozen=True, slots=True)
class Reading:
    """One reading of the three sensors; `None`: this sensor has nothing to say yet."""

    gaze: bool | None
    pressure: bool | None
    location: bool | None


def read(scene: Scene, human: Human) -> Reading:
    """Read gaze, pressure and location.

    A sensor has a reading once the human has begun to take part in its respect, and not while
    the tracked head or hand is moving. The value comes from the bodies alone.
    """
    head_moves, hand_moves = human.is_moving()
    return Reading(
        gaze=None if head_moves or not human.gaze_taken_up else gaze_is_ok(scene),
        pressure=None
        if hand_moves or not human.pressure_taken_up
        else pressure_is_ok(scene, human),
        location=None if hand_moves or not human.location_taken_up else location_is_ok(scene),
    )


def gaze_is_ok(scene: Scene) -> bool:
    """Whether the head is close to the piece and turned towards it.

    Offset is the head's height over the piece, distance is along x, and the angle is that
    between the line of sight and the direction from head to piece.
    """
    head, piece = scene.head.position, scene.piece.position
    towards = math.atan2(piece.y - head.y, piece.x - head.x)
    angle = math.degrees(abs((scene.head.angle - towards + math.pi) % math.tau - math.pi))
    return (
        abs(head.y - piece.y) <= p.GAZE_MAX_OFFSET
        and abs(head.x - piece.x) <= p.GAZE_MAX_DISTANCE
        and angle < p.GAZE_MAX_ANGLE
    )


def location_is_ok(scene: Scene) -> bool:
    """Whether the hand is near the piece on both axes."""
    hand, piece = scene.hand.position, scene.piece.position
    return abs(hand.x - piece.x) <= p.LOCATION_MAX and abs(hand.y - piece.y) <= p.LOCATION_MAX


def pressure_is_ok(scene: Scene, human: Human) -> bool:
    """Whether robot and human both hold the piece, by the forces between them and it."""
    left, right = (contact_force(scene.piece, finger) for finger in scene.fingers)
    by_hand = human.grasp_force() + contact_force(scene.piece, scene.hand)
    return min(left, right) >= p.PRESSURE_MIN and by_hand >= p.PRESSURE_MIN


def hand_distance(scene: Scene) -> float:
    """Metres between the mass centres of hand and gripper."""
    x, z = hand_offset(scene)
    return math.hypot(x, z)


def hand_offset(scene: Scene) -> tuple[float, float]:
    """Metres between the mass centres of hand and gripper on each axis, without sign."""
    x, z = gripper_centre(scene)
    hand = scene.hand.position
    return abs(hand.x - x), abs(hand.y - z)


def tool_speed(scene: Scene) -> float:
    """Metres per second of the palm."""
    return float(scene.links[2].velocity.length)


def gripper_centre(scene: Scene) -> tuple[float, float]:
    """The mass centre of palm and fingers, (x, z) in metres."""
    palm = scene.links[2]
    left, right = scene.fingers
    mass = palm.mass + left.mass + right.mass
    x, z = (palm.position * palm.mass + left.position * left.mass + right.position * right.mass) / (
        mass
    )
    return x, z
