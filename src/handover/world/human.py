"""The human's body: a head that looks and a hand that reaches and takes hold."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import pymunk

from handover.world import parameters as p
from handover.world.measures import contact_forces, gripper_force, seen_piece
from handover.world.motion import PEAK_OVER_MEAN, Quintic, evaluate, quintic, slope
from handover.world.scene import Scene

_HAND = 1
"""The collision type of hands and forearm in pymunk; all other shapes have 0."""


@dataclass(slots=True)
class _Reach:
    """A motion along a quintic path for each coordinate."""

    goal: tuple[float, ...]
    duration: float
    paths: tuple[Quintic, ...]
    elapsed: float = 0.0


class Limb:
    """A kinematic body that moves on minimum-jerk paths and can be redirected at any time.

    Args:
        body: the moving body.
        turns: whether a goal has an angle (rad) after x and z (metres).
    """

    def __init__(self, body: pymunk.Body, *, turns: bool) -> None:
        self._body = body
        self._reach: _Reach | None = None
        self._turns = turns

    def start(self, goal: tuple[float, ...]) -> float:
        """Start to move from the current place to a goal, and return the duration in seconds."""
        here = self._place()
        speed = self._speed()
        brisk = PEAK_OVER_MEAN * math.dist(here[:2], goal[:2]) / p.REACH_SPEED
        duration = max(p.SHORTEST_REACH_S, brisk)
        paths = tuple(quintic(a, v, b, duration) for a, v, b in zip(here, speed, goal, strict=True))
        self._reach = _Reach(goal, duration, paths)
        return duration

    def is_moving(self) -> bool:
        """Whether a motion is under way."""
        return self._reach is not None

    def control(self) -> None:
        """Set the velocity so that the next control step ends on the path."""
        reach = self._reach
        if reach is None:
            return
        if reach.elapsed >= reach.duration:
            self._reach = None
            self._body.velocity = (0.0, 0.0)
            self._body.angular_velocity = 0.0
            return
        reach.elapsed += p.CONTROL_S
        over = reach.elapsed >= reach.duration
        wanted = reach.goal if over else tuple(evaluate(c, reach.elapsed) for c in reach.paths)
        rates = [(b - a) / p.CONTROL_S for a, b in zip(self._place(), wanted, strict=True)]
        self._body.velocity = (rates[0], rates[1])
        if self._turns:
            self._body.angular_velocity = rates[2]

    def _place(self) -> tuple[float, ...]:
        x, z = self._body.position
        return (x, z, self._body.angle) if self._turns else (x, z)

    def _speed(self) -> tuple[float, ...]:
        if self._reach is None:
            return (0.0, 0.0, 0.0) if self._turns else (0.0, 0.0)
        return tuple(slope(c, self._reach.elapsed) for c in self._reach.paths)


class Grasp:
    """A hold of the hand on the piece, from its construction until `let_go`."""

    def __init__(self, scene: Scene) -> None:
        hand, piece = scene.hand, scene.piece
        self._scene = scene
        self._pivot = pymunk.PivotJoint(hand, piece, hand.position)
        self._gear = pymunk.GearJoint(hand, piece, piece.angle - hand.angle, 1.0)
        self._pivot.max_force = p.GRASP_FORCE
        self._gear.max_force = p.GRASP_FORCE * p.HAND_RADIUS
        self._pivot.collide_bodies = False
        self._held_at = piece.world_to_local(hand.position)
        scene.space.add(self._pivot, self._gear)
        scene.hand_pull.max_force = p.HOLD_FORCE

    def force(self) -> float:
        """The force (N) between hand and piece in the last physics step."""
        return self._pivot.impulse / (p.STEP_NS / p.NS)

    def has_slipped(self) -> bool:
        """Whether the hand was torn away from the place at which it took hold."""
        held = self._scene.piece.local_to_world(self._held_at)
        return (held - self._scene.hand.position).length > p.GRASP_SLIP

    def let_go(self) -> None:
        """End the hold."""
        self._scene.space.remove(self._pivot, self._gear)
        self._scene.hand_pull.max_force = p.HAND_FORCE


class Human:
    """Acts on intentions after a reaction time; the physics decides the effect.

    Args:
        scene: the scene of the bodies.
        wake: called with the seconds for which something is going to move.
        after: calls a function after some seconds.
    """

    def __init__(
        self,
        scene: Scene,
        wake: Callable[[float], None],
        after: Callable[[float, Callable[[], None]], None],
    ) -> None:
        self.hand_is_slack = True  # while the human intends neither to close nor to open it
        self._scene = scene
        self._wake = wake
        self._after = after
        self._head = Limb(scene.head, turns=True)
        self._arm = Limb(scene.hand_target, turns=False)
        self._place: tuple[float, float] | None = None
        self._near = False
        self._closed = False
        self._grasp: Grasp | None = None
        self._touches = 0
        arms = scene.arms
        more = () if arms is None else (arms.forearm, arms.other_hand)
        for body in (scene.hand, *more):
            for shape in body.shapes:
                shape.collision_type = _HAND
        scene.space.on_collision(_HAND, None, begin=self._touch, separate=self._part)

    def look(self, offset: float, distance: float, angle: float) -> None:
        """Intend to look at the piece from beside it.

        Args:
            offset: of the head above the piece, m.
            distance: of the head from the piece along x, m.
            angle: between the line of sight and the direction to the piece, degrees.
        """
        self._after(p.REACTION_S, lambda: self._start_to_look(offset, distance, angle))

    def reach(self, dx: float, dz: float, *, near: bool) -> None:
        """Intend to put the hand beside the piece.

        Args:
            dx: m from the piece, towards the human.
            dz: m above the piece.
            near: whether the piece can be taken from this place.
        """
        self._after(p.REACTION_S, lambda: self._start_to_reach((dx, dz), near=near))

    def grasp(self, *, closed: bool) -> None:
        """Intend to hold the piece if the hand is near it, or to let go of it."""
        self._after(p.REACTION_S, lambda: self._start_to_grasp(closed=closed))

    def withdraw(self) -> None:
        """Lose interest: intend to look away and to take the hand back to the chest."""
        self._after(p.REACTION_S, self._start_to_withdraw)

    def control(self) -> None:
        """Move head and arm by a control step; take hold if the closed hand touches the piece."""
        self._head.control()
        self._arm.control()
        self._move_elbow()
        if self._grasp is not None:
            if self._grasp.has_slipped():
                self._let_go()
        elif self._wants_hold() and self._touch_force() > 0.0:
            self._grasp = Grasp(self._scene)

    def is_moving(self) -> tuple[bool, bool]:
        """Whether the head and the hand are moving, so that trackers give no reading."""
        hand = self._arm.is_moving() or self._scene.hand.velocity.length > p.STILL_SPEED
        return self._head.is_moving(), hand

    def hand_force(self) -> float:
        """The largest force (N) with which a single body of the robot, or the piece, presses.

        Forces of two fingers that clamp the hand do not add up: each balances the other.
        """
        if not self._touches and self._grasp is None:
            return 0.0
        return self._pressed(self._scene.hand, self._grasp_force())

    def arm_forces(self) -> tuple[float, float]:
        """The same for forearm and other hand of a person beside the robot's way."""
        arms = self._scene.arms
        if not self._touches or arms is None:
            return 0.0, 0.0
        return self._pressed(arms.forearm), self._pressed(arms.other_hand)

    def holds(self) -> bool:
        """Whether the hand has taken hold of the piece."""
        return self._grasp is not None

    def shares_piece(self) -> bool:
        """Whether robot and human both hold the piece, judged by their forces on it."""
        enough = self._grasp_force() + self._touch_force() >= p.PRESSURE_MIN
        return enough and gripper_force(self._scene) >= p.PRESSURE_MIN

    def _touch(self, *_: object) -> None:
        self._touches += 1

    def _part(self, *_: object) -> None:
        self._touches -= 1

    def _forces(self, body: pymunk.Body) -> dict[pymunk.Body, float]:
        # Called at each physics step, and most of the time nothing touches the person.
        return contact_forces(body) if self._touches else {}

    def _pressed(self, body: pymunk.Body, by_grasp: float = 0.0) -> float:
        forces = self._forces(body)
        by_piece = by_grasp + forces.get(self._scene.piece, 0.0)
        parts = (self._scene.links[2], *self._scene.fingers)
        return max(by_piece, *(forces.get(part, 0.0) for part in parts))

    def _touch_force(self) -> float:
        return self._forces(self._scene.hand).get(self._scene.piece, 0.0)

    def _grasp_force(self) -> float:
        return 0.0 if self._grasp is None else self._grasp.force()

    def _start_to_look(self, offset: float, distance: float, angle: float) -> None:
        piece_x, piece_z = seen_piece(self._scene)
        x, z = piece_x + distance, piece_z + offset
        towards = math.atan2(piece_z - z, piece_x - x) % math.tau
        self._wake(self._head.start((x, z, towards - math.radians(angle))))

    def _start_to_reach(self, place: tuple[float, float], *, near: bool) -> None:
        self._place, self._near = place, near
        self._move_hand()

    def _start_to_grasp(self, *, closed: bool) -> None:
        self.hand_is_slack = False
        self._closed = closed
        if self._near:
            self._move_hand()

    def _start_to_withdraw(self) -> None:
        self._place, self._near, self._closed, self.hand_is_slack = None, False, False, True
        self._let_go()
        self._wake(self._head.start((*p.HEAD_REST, p.HEAD_REST_ANGLE)))
        self._wake(self._arm.start(self._scene.hand_rest))

    def _wants_hold(self) -> bool:
        return self._closed and self._near

    def _move_hand(self) -> None:
        if not self._wants_hold():
            self._let_go()
        if self._place is not None and self._grasp is None:
            goal = self._hold_point() if self._wants_hold() else self._near_piece(*self._place)
            self._wake(self._arm.start(goal))

    def _move_elbow(self) -> None:
        """Pull the elbow behind the hand, in the direction of its place when the arm hangs."""
        arms, target = self._scene.arms, self._scene.hand_target
        if arms is not None:
            hand = target.position + target.velocity * p.CONTROL_S
            elbow = hand + (arms.elbow - hand).normalized() * p.LOWER_ARM[1]
            arms.elbow_target.velocity = (elbow - arms.elbow_target.position) / p.CONTROL_S

    def _let_go(self) -> None:
        if self._grasp is not None:
            self._grasp.let_go()
            self._grasp = None

    def _near_piece(self, dx: float, dz: float) -> tuple[float, float]:
        piece_x, piece_z = seen_piece(self._scene)
        x, z = piece_x + dx, piece_z + dz
        above_table = p.TABLE[0] <= x <= p.TABLE[1] + p.HAND_RADIUS and piece_z > 0
        return (x, max(z, p.HAND_RADIUS)) if above_table else (x, z)

    def _hold_point(self) -> tuple[float, float]:
        """The point at which the hand takes the piece: its top if it stands, else its free end."""
        x, z = seen_piece(self._scene)
        width, height = p.PIECE_SIZE
        reach = p.HAND_RADIUS - p.GRASP_DEPTH
        stands_on_table = abs(z - height / 2) < height / 10
        if stands_on_table:
            return x, z + height / 2 + reach
        return x + width / 2 + reach, z - 0.3 * height
