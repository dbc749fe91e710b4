"""A part of the human's body that moves by itself."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pymunk

from handover.world import parameters as p
from handover.world.motion import PEAK_OVER_MEAN, Quintic, evaluate, quintic, slope


@dataclass(slots=True)
class _Reach:
    """A motion under way or still to begin, along one quintic path for each coordinate."""

    goal: tuple[float, ...]
    duration: float
    paths: tuple[Quintic, ...]
    elapsed: float = 0.0


class Limb:
    """A kinematic body that is moved on minimum-jerk paths; it may be redirected in flight.

    Args:
        body: what moves.
        turns: whether a goal has an angle (rad) after x and z (metres).
    """

    def __init__(self, body: pymunk.Body, *, turns: bool) -> None:
        self._body = body
        self._reach: _Reach | None = None
        self._turns = turns

    def start(self, goal: tuple[float, ...]) -> float:
        """Begin to move to a goal from where the limb is; returns the seconds that it takes."""
        here = self._place()
        speed = self._speed()
        duration = max(
            p.SHORTEST_REACH_S, PEAK_OVER_MEAN * math.dist(here[:2], goal[:2]) / p.REACH_SPEED
        )
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
