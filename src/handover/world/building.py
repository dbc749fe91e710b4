"""Build the physical scene: arm, gripper, piece, table and human."""

from __future__ import annotations

import math
from collections.abc import Iterable

import pymunk

from handover.world import parameters as p
from handover.world.faults import SceneFaults
from handover.world.motion import Joints
from handover.world.scene import Arms, Scene

AS_PLANNED = SceneFaults()

_SCENERY = 1
_PIECE = 2
_GRIPPER = 4
_HAND = 8
_BESIDE = 16
_FINGER_X = p.PALM_LENGTH / 2
_FINGER_OFFSET = (p.PIECE_SIZE[0] + p.FINGER_THICKNESS) / 2


def build(pose: Joints, faults: SceneFaults = AS_PLANNED) -> Scene:
    """Build the scene with the arm in a pose, the piece on the table and the human at rest.

    The piece collides with everything; gripper and hand also collide with table and floor. Hand and
    gripper pass each other, as the plane is a projection and the hand may be in front (requirement
    5 measures how close they come), unless the faults put the hand into the plane. Forearm and
    other hand of a person beside the way collide with gripper, piece and table. The links of the
    arm collide with nothing.
    """
    space = pymunk.Space()
    space.gravity = (0.0, -p.GRAVITY)
    space.iterations = p.ITERATIONS
    space.collision_slop = 0.0005
    _add_scenery(space, faults.raised_m)
    links, joint_motors = _add_arm(space, pose)
    fingers, finger_motors = _add_fingers(space, links[2])
    piece = _add_piece(space, faults.friction, faults.raised_m)
    rest, arms = p.HAND_REST, None
    if faults.beside_m is not None:  # the x of the taking arm and of the other one
        places = (faults.beside_m + arm for arm in p.BESIDE_ARMS)
        own, other = sorted(places, reverse=faults.far_hand)
        rest = _from(own, p.BESIDE_REST)
    hand, hand_target, hand_pull = _add_hand(space, rest, _HAND, _SCENERY, _PIECE)
    if faults.beside_m is not None:
        arms = _add_arms(space, hand, own, other)
    if faults.hand_in_plane:
        _meet((*links[2:], *fingers), _HAND)
        _meet((hand,), _GRIPPER)
    if arms is not None:
        _meet((*links[2:], *fingers, piece), _BESIDE)
    head = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    head.position = p.HEAD_REST
    head.angle = p.HEAD_REST_ANGLE
    space.add(head)
    return Scene(
        space, links, joint_motors, fingers, finger_motors, piece, hand, rest, hand_target,
        hand_pull, head, arms,
    )  # fmt: skip


def _from(x: float, place: tuple[float, float]) -> tuple[float, float]:
    return x + place[0], place[1]


def _filter(category: int, *collides_with: int) -> pymunk.ShapeFilter:
    return pymunk.ShapeFilter(categories=category, mask=sum(collides_with))


def _meet(bodies: Iterable[pymunk.Body], category: int) -> None:
    """Let bodies also collide with a category."""
    for body in bodies:
        for shape in body.shapes:
            own = shape.filter
            shape.filter = pymunk.ShapeFilter(categories=own.categories, mask=own.mask | category)


def table_corners() -> tuple[tuple[float, float], ...]:
    """The table's outline in the scene, metres."""
    left, right = p.TABLE
    return ((left, -p.TABLE_THICKNESS), (right, -p.TABLE_THICKNESS), (right, 0.0), (left, 0.0))


def box_corners(length: float, width: float) -> tuple[tuple[float, float], ...]:
    """The outline of a box around its centre, metres."""
    x, z = length / 2, width / 2
    return (-x, -z), (x, -z), (x, z), (-x, z)


def _add_scenery(space: pymunk.Space, raised_m: float) -> None:
    table = pymunk.Poly(space.static_body, table_corners())
    # A thick segment, so that nothing falls through within one step.
    floor = pymunk.Segment(space.static_body, (-2.0, p.FLOOR_Z - 0.1), (3.0, p.FLOOR_Z - 0.1), 0.1)
    shapes: list[pymunk.Shape] = [table, floor]
    if raised_m:
        left, right = p.PIECE_X - p.PIECE_SIZE[0] / 2, p.PIECE_X + p.PIECE_SIZE[0] / 2
        # A block on the table under the piece, as wide as that.
        block = ((left, 0.0), (right, 0.0), (right, raised_m), (left, raised_m))
        shapes.append(pymunk.Poly(space.static_body, block))
    for shape in shapes:
        shape.friction = p.TABLE_FRICTION
        shape.filter = _filter(_SCENERY, _PIECE, _GRIPPER, _HAND)
    space.add(*shapes)


def _add_arm(
    space: pymunk.Space, pose: Joints
) -> tuple[
    tuple[pymunk.Body, pymunk.Body, pymunk.Body],
    tuple[pymunk.SimpleMotor, pymunk.SimpleMotor, pymunk.SimpleMotor],
]:
    x, z = p.SHOULDER
    angle = 0.0
    before = space.static_body
    links: list[pymunk.Body] = []
    motors: list[pymunk.SimpleMotor] = []
    sizes = ((p.UPPER_ARM, 0.06), (p.FOREARM, 0.05), (p.PALM_LENGTH, p.PALM_WIDTH))
    for size, mass, joint in zip(sizes, p.LINK_MASSES, pose, strict=True):
        length = size[0]
        angle += joint
        link = pymunk.Body(mass, pymunk.moment_for_box(mass, size))
        link.angle = angle
        link.position = (x + length / 2 * math.cos(angle), z + length / 2 * math.sin(angle))
        motor = pymunk.SimpleMotor(before, link, 0.0)
        motor.max_force = p.JOINT_TORQUE
        space.add(link, _hinge(before, link, (x, z)), motor)
        links.append(link)
        motors.append(motor)
        x, z = x + length * math.cos(angle), z + length * math.sin(angle)
        before = link
    palm = pymunk.Poly(links[2], box_corners(p.PALM_LENGTH, p.PALM_WIDTH))
    palm.friction = p.FRICTION
    palm.filter = _filter(_GRIPPER, _SCENERY, _PIECE)
    space.add(palm)
    return (links[0], links[1], links[2]), (motors[0], motors[1], motors[2])


def _hinge(a: pymunk.Body, b: pymunk.Body, at: tuple[float, float]) -> pymunk.PivotJoint:
    hinge = pymunk.PivotJoint(a, b, at)
    # The share of a position error that is left after one second, per pymunk: repair 30 % of it
    # in each sixtieth of a second.
    hinge.error_bias = 0.7**60
    return hinge


def _add_fingers(
    space: pymunk.Space, palm: pymunk.Body
) -> tuple[tuple[pymunk.Body, pymunk.Body], tuple[pymunk.SimpleMotor, pymunk.SimpleMotor]]:
    fingers: list[pymunk.Body] = []
    motors: list[pymunk.SimpleMotor] = []
    length = p.FINGER_LENGTH / 2
    for side in (1, -1):
        root = palm.local_to_world((_FINGER_X, _FINGER_OFFSET * side))
        finger = pymunk.Body(p.FINGER_MASS, p.FINGER_MASS * p.FINGER_LENGTH**2 / 6)
        finger.angle = palm.angle + side * p.FINGER_OPEN
        finger.position = (
            root.x + length * math.cos(finger.angle),
            root.y + length * math.sin(finger.angle),
        )
        shape = pymunk.Poly(finger, box_corners(p.FINGER_LENGTH, p.FINGER_THICKNESS))
        shape.friction = p.FRICTION
        shape.filter = _filter(_GRIPPER, _SCENERY, _PIECE)
        motor = pymunk.SimpleMotor(palm, finger, 0.0)
        motor.max_force = p.FINGER_TORQUE
        low, high = sorted((side * p.FINGER_OVERCLOSED, side * p.FINGER_OPEN))
        limit = pymunk.RotaryLimitJoint(palm, finger, low, high)
        space.add(finger, shape, _hinge(palm, finger, (root.x, root.y)), motor, limit)
        fingers.append(finger)
        motors.append(motor)
    return (fingers[0], fingers[1]), (motors[0], motors[1])


def _add_piece(space: pymunk.Space, friction: float, raised_m: float) -> pymunk.Body:
    piece = pymunk.Body(p.PIECE_MASS, pymunk.moment_for_box(p.PIECE_MASS, p.PIECE_SIZE))
    piece.position = (p.PIECE_X, raised_m + p.PIECE_SIZE[1] / 2)
    shape = pymunk.Poly.create_box(piece, p.PIECE_SIZE)
    shape.friction = friction
    shape.filter = _filter(_PIECE, _SCENERY, _GRIPPER, _HAND)
    space.add(piece, shape)
    return piece


def _add_hand(
    space: pymunk.Space, place: tuple[float, float], category: int, *meets: int
) -> tuple[pymunk.Body, pymunk.Body, pymunk.PivotJoint]:
    hand = pymunk.Body(p.HAND_MASS, math.inf)
    hand.position = place
    shape = pymunk.Circle(hand, p.HAND_RADIUS)
    shape.friction = p.FRICTION
    shape.filter = _filter(category, *meets)
    space.add(hand, shape)
    target, pull = _pulled(space, hand, (0.0, 0.0), p.HAND_FORCE)
    return hand, target, pull


def _pulled(
    space: pymunk.Space, body: pymunk.Body, at: tuple[float, float], force: float
) -> tuple[pymunk.Body, pymunk.PivotJoint]:
    """A target that pulls a point of a body with a bounded force (N)."""
    target = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    target.position = body.local_to_world(at)
    pull = pymunk.PivotJoint(target, body, (0.0, 0.0), at)
    pull.max_force = force
    space.add(target, pull)
    return target, pull


def _add_arms(space: pymunk.Space, hand: pymunk.Body, own_x: float, other_x: float) -> Arms:
    """Add forearm and other hand. The forearm has no weight, as the shoulder carries it."""
    wrist, elbow = p.LOWER_ARM
    elbow_rest = _from(own_x, p.BESIDE_ELBOW)
    size = (elbow - wrist, 2 * p.LOWER_ARM_RADIUS)
    forearm = pymunk.Body(p.LOWER_ARM_MASS, pymunk.moment_for_box(p.LOWER_ARM_MASS, size))
    along = (hand.position - elbow_rest).normalized()
    forearm.position = hand.position - along * ((wrist + elbow) / 2)
    forearm.angle = along.angle
    forearm.velocity_func = _carried
    half = size[0] / 2 - p.LOWER_ARM_RADIUS
    shape = pymunk.Segment(forearm, (-half, 0.0), (half, 0.0), p.LOWER_ARM_RADIUS)
    shape.friction = p.FRICTION
    meets = (_SCENERY, _PIECE, _GRIPPER)
    shape.filter = _filter(_BESIDE, *meets)
    space.add(forearm, shape, _hinge(hand, forearm, hand.position))
    target, _ = _pulled(space, forearm, ((wrist - elbow) / 2, 0.0), p.ELBOW_FORCE)
    other, _, _ = _add_hand(space, _from(other_x, p.BESIDE_OTHER), _BESIDE, *meets)
    return Arms(forearm, target, elbow_rest, other)


def _carried(body: pymunk.Body, _: tuple[float, float], damping: float, dt: float) -> None:
    pymunk.Body.update_velocity(body, (0.0, 0.0), damping, dt)
