"""The human's body: a head that looks and a hand that reaches and takes hold."""

from __future__ import annotations

import math
from collections.abc import Callable

import pymunk

from handover.world import parameters as p
from handover.world.limb import Limb
from handover.world.measures import contact_force, seen_piece
from handover.world.scene import Scene

Point = tuple[float, float]


class Human:
    """Follows intentions after a reaction time; what it achieves, the physics decides.

    Attributes:
        gaze_taken_up, location_taken_up, pressure_taken_up: whether the human has begun to take
            part in that respect, so that trackers have locked on to it.
    """

    def __init__(
        self,
        scene: Scene,
        wake: Callable[[float], None],
        after: Callable[[float, Callable[[], None]], None],
    ) -> None:
        self.gaze_taken_up = False
        self.location_taken_up = False
        self.pressure_taken_up = False
        self._scene = scene
        self._wake = wake
        self._after = after
        self._head = Limb(scene.head, turns=True)
        self._arm = Limb(scene.hand_target, turns=False)
        self._gaze: tuple[float, float, float] | None = None
        self._place: Point | None = None
        self._near = False
        self._closed = False
        self._grasp: tuple[pymunk.PivotJoint, pymunk.GearJoint] | None = None
        self._held_at: pymunk.Vec2d | None = None

    def look(self, offset: float, distance: float, angle: float) -> None:
        """Intend to look at the piece from beside it.

        Args:
            offset: of the head above the piece, m.
            distance: of the head from the piece along x, m.
            angle: between the line of sight and the direction to the piece, degrees.
        """
        self._gaze = (offset, distance, angle)
        self._after(p.REACTION_S, self._start_to_look)

    def reach(self, dx: float, dz: float, *, near: bool) -> None:
        """Intend to have the hand beside the piece.

        Args:
            dx: m from the piece, towards the human.
            dz: m above the piece.
            near: this is a place from which the piece can be taken.
        """
        self._place, self._near = (dx, dz), near
        self._after(p.REACTION_S, self._start_to_reach)

    def grasp(self, *, closed: bool) -> None:
        """Intend to hold the piece if the hand is near it, or to let go of it."""
        self._closed = closed
        self._after(p.REACTION_S, self._start_to_grasp)

    def control(self) -> None:
        """Move head and arm on, take hold where the closed hand touches the piece."""
        self._head.control()
        self._arm.control()
        if self._grasp is not None:
            if not self._wants_hold() or self._has_slipped():
                self._let_go()
        elif self._wants_hold() and self._touches():
            self._take_hold()

    def is_moving(self) -> tuple[bool, bool]:
        """Whether head and hand are moving, so that trackers give no reading."""
        hand = self._arm.is_moving() or self._scene.hand.velocity.length > p.STILL_SPEED
        return self._head.is_moving(), hand

    def grasp_force(self) -> float:
        """N that the closed hand exchanges with the piece through its grasp."""
        if self._grasp is None:
            return 0.0
        return self._grasp[0].impulse / (p.STEP_NS / p.NS)

    def _start_to_look(self) -> None:
        assert self._gaze is not None  # noqa: S101  # set by look(), which enters this call
        offset, distance, angle = self._gaze
        piece_x, piece_z = seen_piece(self._scene)
        x, z = piece_x + distance, piece_z + offset
        towards = math.atan2(piece_z - z, piece_x - x) % math.tau
        self.gaze_taken_up = True
        self._wake(self._head.start((x, z, towards - math.radians(angle))))

    def _start_to_reach(self) -> None:
        self.location_taken_up = True
        self._move_hand()

    def _start_to_grasp(self) -> None:
        self.pressure_taken_up = True
        if self._near:
            self._move_hand()

    def _move_hand(self) -> None:
        if self._place is None:
            return
        if not self._wants_hold():
            self._let_go()
        if self._grasp is None:
            goal = self._hold_point() if self._wants_hold() else self._beside()
            self._wake(self._arm.start(goal))

    def _wants_hold(self) -> bool:
        return self._closed and self._near

    def _beside(self) -> Point:
        assert self._place is not None  # noqa: S101  # _move_hand() has checked it
        piece_x, piece_z = seen_piece(self._scene)
        x, z = piece_x + self._place[0], piece_z + self._place[1]
        above_table = p.TABLE[0] <= x <= p.TABLE[1] + p.HAND_RADIUS and piece_z > 0
        return (x, max(z, p.HAND_RADIUS)) if above_table else (x, z)

    def _hold_point(self) -> Point:
        """People lift a thing from a table by its top, and take a held one by its free end."""
        x, z = seen_piece(self._scene)
        width, height = p.PIECE_SIZE
        reach = p.HAND_RADIUS - p.GRASP_DEPTH
        stands_on_table = abs(z - height / 2) < height / 10
        if stands_on_table:
            return x, z + height / 2 + reach
        return x + width / 2 + reach, z - 0.3 * height

    def _touches(self) -> bool:
        return contact_force(self._scene.hand, self._scene.piece) > 0.0

    def _take_hold(self) -> None:
        hand, piece = self._scene.hand, self._scene.piece
        pivot = pymunk.PivotJoint(hand, piece, hand.position)
        gear = pymunk.GearJoint(hand, piece, piece.angle - hand.angle, 1.0)
        pivot.max_force = p.GRASP_FORCE
        gear.max_force = p.GRASP_FORCE * p.HAND_RADIUS
        pivot.collide_bodies = False
        self._scene.space.add(pivot, gear)
        self._scene.hand_pull.max_force = p.HOLD_FORCE
        self._grasp = (pivot, gear)
        self._held_at = piece.world_to_local(hand.position)

    def _has_slipped(self) -> bool:
        assert self._held_at is not None  # noqa: S101  # set with the grasp
        held = self._scene.piece.local_to_world(self._held_at)
        return (held - self._scene.hand.position).length > p.GRASP_SLIP

    def _let_go(self) -> None:
        if self._grasp is not None:
            self._scene.space.remove(*self._grasp)
            self._scene.hand_pull.max_force = p.HAND_FORCE
            self._grasp = self._held_at = None
