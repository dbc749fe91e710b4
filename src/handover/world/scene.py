"""The physical scene as data: its bodies, shapes and joints."""

from __future__ import annotations

from dataclasses import dataclass

import pymunk


@dataclass(frozen=True, slots=True)
class Scene:
    """All bodies, with the motors that controllers write to.

    Attributes:
        space: pymunk's space, gravity along −z (pymunk's y is z here).
        links: upper arm, forearm, palm.
        joint_motors: one for each joint, shoulder first.
        fingers: left and right.
        finger_motors: a positive `rate` times the side (+1, −1) closes.
        piece: the thing that is handed over.
        hand: of the human; never turns.
        hand_target: where the human's arm pulls the hand to.
        hand_pull: the pull itself, with its largest force.
        head: of the human; its angle is the direction of gaze.
    """

    space: pymunk.Space
    links: tuple[pymunk.Body, pymunk.Body, pymunk.Body]
    joint_motors: tuple[pymunk.SimpleMotor, pymunk.SimpleMotor, pymunk.SimpleMotor]
    fingers: tuple[pymunk.Body, pymunk.Body]
    finger_motors: tuple[pymunk.SimpleMotor, pymunk.SimpleMotor]
    piece: pymunk.Body
    hand: pymunk.Body
    hand_target: pymunk.Body
    hand_pull: pymunk.PivotJoint
    head: pymunk.Body
