"""The closed hand's hold on the piece: joints that transmit a limited force."""

from __future__ import annotations

import pymunk

from handover.world import parameters as p
from handover.world.scene import Scene


class Grasp:
    """Holds from its making until `let_go`; the piece keeps its place in the hand."""

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
        """N that hand and piece exchanged in the last step."""
        return self._pivot.impulse / (p.STEP_NS / p.NS)

    def has_slipped(self) -> bool:
        """Whether the hand was torn away from where it took hold."""
        held = self._scene.piece.local_to_world(self._held_at)
        return (held - self._scene.hand.position).length > p.GRASP_SLIP

    def let_go(self) -> None:
        """End the hold."""
        self._scene.space.remove(self._pivot, self._gear)
        self._scene.hand_pull.max_force = p.HAND_FORCE
