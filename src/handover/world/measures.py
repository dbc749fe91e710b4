"""Plain measurements on the bodies of the scene."""

from __future__ import annotations

import math
from collections.abc import Callable

import pymunk

from handover.world import parameters as p
from handover.world.scene import Scene

_BETWEEN_PADS = (p.WRIST_TO_GRIP - p.PALM_LENGTH / 2, 0.0)
"""On the palm, from its centre, metres."""


def contact_forces(body: pymunk.Body) -> dict[pymunk.Body, float]:
    """N between a body and each that touches it, in the last physics step, by contact alone.

    Two may touch at several places: these forces add up as vectors.
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
    """The error of a measurement that has none."""
    return 0.0


def gaze_is_ok(scene: Scene, error: Callable[[], float] = exactly) -> bool:
    """Whether the head is close to the piece and turned towards it.

    Offset is the head's height over the piece, distance is along x, and the angle is that
    between the line of sight and the direction from head to piece.

    `error` gives the offset of each measured length, m.
    """
    head, piece = scene.head.position, scene.piece.position
    return (
        abs(head.y - piece.y + error()) <= p.GAZE_MAX_OFFSET
        and abs(head.x - piece.x + error()) <= p.GAZE_MAX_DISTANCE
        and _turn_from_piece(scene) < p.GAZE_MAX_ANGLE
    )


def face_is_seen(scene: Scene) -> bool:
    """Whether the head is turned to the piece so far that a tracker finds its eyes."""
    return _turn_from_piece(scene) < p.FACE_MAX_ANGLE


def hand_is_seen(scene: Scene) -> bool:
    """Whether a tracker can tell the hand from the chest."""
    return (scene.hand.position - scene.hand_rest).length > p.HAND_MIN_OFFSET


def _turn_from_piece(scene: Scene) -> float:
    """Degrees between the line of sight and the direction from head to piece."""
    head, piece = scene.head.position, scene.piece.position
    towards = math.atan2(piece.y - head.y, piece.x - head.x)
    turn = (scene.head.angle - towards + math.pi) % math.tau - math.pi
    return math.degrees(abs(turn))


def location_is_ok(scene: Scene, error: Callable[[], float] = exactly) -> bool:
    """Whether the hand is near the piece on both axes; arguments as of `gaze_is_ok`."""
    hand, piece = scene.hand.position, scene.piece.position
    return (
        abs(hand.x - piece.x + error()) <= p.LOCATION_MAX
        and abs(hand.y - piece.y + error()) <= p.LOCATION_MAX
    )


def gripper_force(scene: Scene) -> float:
    """N with which the weaker of both fingers presses on the piece."""
    forces = contact_forces(scene.piece)
    return min(forces.get(finger, 0.0) for finger in scene.fingers)


def gripper_opening(scene: Scene) -> float:
    """Metres between the tips of the fingers, at their middle lines."""
    tips = [finger.local_to_world((p.FINGER_LENGTH / 2, 0.0)) for finger in scene.fingers]
    return float((tips[0] - tips[1]).length)


def hand_offset(scene: Scene) -> tuple[float, float]:
    """Metres between the mass centres of gripper and nearest hand on each axis, without sign."""
    return _hand_offset(scene, gripper_centre(scene))


def person_distances(scene: Scene) -> tuple[float, float]:
    """Metres from the gripper's mass centre to the nearest hand, and to the nearest body part.

    That is a hand, the head or the forearm's axis.
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
    """Metres from the gripper's axis, its grip at a point, to forearm and other hand.

    They are those of a person beside the way; nobody is there: infinite.
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
    """Metres per second of the point between the pads."""
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
