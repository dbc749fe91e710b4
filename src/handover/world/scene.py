"""The physical scene as data: its bodies, shapes and joints."""

from __future__ import annotations

from dataclasses import dataclass

import pymunk


@dataclass(frozen=True, slots=True)
class Arms:
    """The bodies in the plane, besides the taking hand, of a person beside the robot's way."""

    forearm: pymunk.Body  # from the wrist to the elbow; its x axis points to the wrist
    elbow_target: pymunk.Body  # the point to which the elbow is pulled
    elbow: tuple[float, float]  # position of the elbow when the arm hangs, (x, z) in metres
    other_hand: pymunk.Body  # stays in place


@dataclass(frozen=True, slots=True)
class Scene:
    """All bodies, and the motors that controllers write to."""

    space: pymunk.Space  # pymunk's space, gravity along −z (pymunk's y is z here)
    links: tuple[pymunk.Body, pymunk.Body, pymunk.Body]  # upper arm, forearm, palm
    # Motors of the joints, shoulder first.
    joint_motors: tuple[pymunk.SimpleMotor, pymunk.SimpleMotor, pymunk.SimpleMotor]
    fingers: tuple[pymunk.Body, pymunk.Body]  # left and right
    # A finger closes if `rate` times its side (+1, −1) is positive.
    finger_motors: tuple[pymunk.SimpleMotor, pymunk.SimpleMotor]
    piece: pymunk.Body  # the object that is handed over
    hand: pymunk.Body  # the human's taking hand; never turns
    hand_rest: tuple[float, float]  # its position at rest, (x, z) in metres
    hand_target: pymunk.Body  # the point to which the human's arm pulls the hand
    hand_pull: pymunk.PivotJoint  # the pull itself, with its largest force
    head: pymunk.Body  # the human's head; its angle is the direction of gaze
    arms: Arms | None  # further bodies of a human who stands beside the robot's way
