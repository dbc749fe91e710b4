"""Measurements on the bodies of the scene."""

from __future__ import annotations

import math
from collections.abc import Callable

import pymunk

from handover.world import parameters as p
from handover.world.scene import Scene

_BETWEEN_PADS = (p.WRIST_TO_GRIP - p.PALM_LENGTH / 2, 0.0)
"""The point between the pads, relative to the centre of the palm, metres."""


def contact_forces(body: pymunk.Body) -> dict[pymunk.Body, float]:
    """The contact force (N) between a body and each body touching it, in the last physics step.

    The forces at several contact points of two bodies add up as vectors.
    """
    impulses: dict[pymunk.Body, pymunk.Vec2d] = {}

    def collect(arbiter: pymunk.Arbiter) -> None:
        first, second = arbiter.bodies
        impulse = arbiter.total_impulse
        other, own = (second, impulse) if first is body else (first, -impulse)
        impulses[other] = impulses[other] + own if other in impulses else own

    body.each_arbiter(collect)
    return {other: whole.length / (p.STEP_NS / p.NS) for other, whole in impulses.items()}


def seen_piece(scene: Scene) -> tuple[float, float]:
    """The position of the piece as camera and eyes see it, (x, z) in metres."""
    x, z = scene.piece.position
    return round(x, p.SIGHT_RESOLUTION_DIGITS), round(z, p.SIGHT_RESOLUTION_DIGITS)


def exactly() -> float:
    """The error of an exact measurement."""
    return 0.0


def gaze_is_ok(scene: Scene, error: Callable[[], float] = exactly) -> bool:
    """Whether the head is close to the piece and turned towards it.

    It is if three values are within their limits: the height of the head above the piece, their
    distance along x, and the angle between the line of sight and the direction to the piece.

    `error` draws the error of each measured length, m.
    """
    head, piece = scene.head.position, scene.piece.position
    return (
        abs(head.y - piece.y + error()) <= p.GAZE_MAX_OFFSET
        and abs(head.x - piece.x + error()) <= p.GAZE_MAX_DISTANCE
        and _turn_from_piece(scene) < p.GAZE_MAX_ANGLE
    )


def face_is_seen(scene: Scene) -> bool:
    """Whether the head is turned towards the piece enough for a tracker to find its eyes."""
    return _turn_from_piece(scene) < p.FACE_MAX_ANGLE


def hand_is_seen(scene: Scene) -> bool:
    """Whether a tracker can distinguish the hand from the chest."""
    return (scene.hand.position - scene.hand_rest).length > p.HAND_MIN_OFFSET


def _turn_from_piece(scene: Scene) -> float:
    """The angle (degrees) between the line of sight and the direction from head to piece."""
    head, piece = scene.head.position, scene.piece.position
    towards = math.atan2(piece.y - head.y, piece.x - head.x)
    turn = (scene.head.angle - towards + math.pi) % math.tau - math.pi
    return math.degrees(abs(turn))


def location_is_ok(scene: Scene, error: Callable[[], float] = exactly) -> bool:
    """Whether the hand is near the piece on both axes; arguments as for `gaze_is_ok`."""
    hand, piece = scene.hand.position, scene.piece.position
    return (
        abs(hand.x - piece.x + error()) <= p.LOCATION_MAX
        and abs(hand.y - piece.y + error()) <= p.LOCATION_MAX
    )


def gripper_force(scene: Scene) -> float:
    """The force (N) with which the weaker of both fingers presses on the piece."""
    forces = contact_forces(scene.piece)
    return min(forces.get(finger, 0.0) for finger in scene.fingers)


def gripper_opening(scene: Scene) -> float:
    """The distance (m) between the tips of the fingers, at their centre lines."""
    tips = [finger.local_to_world((p.FINGER_LENGTH / 2, 0.0)) for finger in scene.fingers]
    return float((tips[0] - tips[1]).length)


def hand_offset(scene: Scene) -> tuple[float, float]:
    """The distance (m) on each axis between the mass centres of gripper and nearest hand."""
    return _hand_offset(scene, gripper_centre(scene))


def person_distances(scene: Scene) -> tuple[float, float]:
    """The distances (m) of the gripper's mass centre to the nearest hand and nearest body part.

    A body part is a hand, the head, or the axis of the forearm.
    """
    centre = pymunk.Vec2d(*gripper_centre(scene))
    to_hand = math.hypot(*_hand_offset(scene, centre))
    parts = [to_hand, (scene.head.position - centre).length]
    if scene.arms is not None:
        (bone,) = scene.arms.forearm.shapes
        parts.append(bone.point_query(centre).distance + p.LOWER_ARM_RADIUS)
    return to_hand, min(parts)


def _hand_offset(scene: Scene, centre: tuple[float, float]) -> tuple[float, float]:
    hands = [scene.hand] if scene.arms is None else [scene.hand, scene.arms.other_hand]
    places = (hand.position for hand in hands)
    offsets = [(abs(x - centre[0]), abs(z - centre[1])) for x, z in places]
    return min(offsets, key=lambda offset: math.hypot(*offset))


def beside_distance(scene: Scene, x: float, z: float) -> float:
    """The distance (m) of a person beside the way (forearm and other hand) from the gripper's axis.

    `x` and `z` (m) are the position of the grip. The distance is infinite if nobody is there.
    """
    if scene.arms is None:
        return math.inf
    low, high = p.GRIPPER_REACH
    return min(
        shape.point_query((x, at)).distance
        for body in (scene.arms.forearm, scene.arms.other_hand)
        for shape in body.shapes
        for at in (z - low, z, z + high)
    )


def tool_speed(scene: Scene) -> float:
    """The speed (m/s) of the point between the pads."""
    return float(scene.links[2].velocity_at_local_point(_BETWEEN_PADS).length)


def tool_point(scene: Scene) -> tuple[float, float]:
    """The point between the pads, (x, z) in metres."""
    x, z = scene.links[2].local_to_world(_BETWEEN_PADS)
    return x, z


def gripper_centre(scene: Scene) -> tuple[float, float]:
    """The mass centre of palm and fingers, (x, z) in metres."""
    left, right = scene.fingers
    one, two, three = scene.links[2].position, left.position, right.position
    palm, finger = p.LINK_MASSES[2], p.FINGER_MASS
    mass = palm + finger + finger
    x = (palm * one.x + finger * two.x + finger * three.x) / mass
    z = (palm * one.y + finger * two.y + finger * three.y) / mass
    return x, z
