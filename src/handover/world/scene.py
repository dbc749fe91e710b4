"""The physical scene as data: its bodies, shapes and joints."""

from __future__ import annotations

from dataclasses import dataclass

import pymunk


@dataclass(frozen=True, slots=True)
class Beside:
    """The bodies of a person beside the robot's way in its plane, besides the taking hand.

    Attributes:
        forearm: from the wrist to the elbow; its x axis points to the wrist.
        elbow_target: the point that the elbow is pulled to.
        elbow: its position when the arm hangs, (x, z) in metres.
        other_hand: stays in place.
    """

    forearm: pymunk.Body
    elbow_target: pymunk.Body
    elbow: tuple[float, float]
    other_hand: pymunk.Body


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
        hand: of the human, the one that takes; never turns.
        hand_rest: its position at rest, (x, z) in metres.
        hand_target: the point to which the human's arm pulls the hand.
        hand_pull: the pull itself, with its largest force.
        head: of the human; its angle is the direction of gaze.
        beside: the rest of a human who stands beside the way.
    """

    space: pymunk.Space
    links: tuple[pymunk.Body, pymunk.Body, pymunk.Body]
    joint_motors: tuple[pymunk.SimpleMotor, pymunk.SimpleMotor, pymunk.SimpleMotor]
    fingers: tuple[pymunk.Body, pymunk.Body]
    finger_motors: tuple[pymunk.SimpleMotor, pymunk.SimpleMotor]
    piece: pymunk.Body
    hand: pymunk.Body
    hand_rest: tuple[float, float]
    hand_target: pymunk.Body
    hand_pull: pymunk.PivotJoint
    head: pymunk.Body
    beside: Beside | None
