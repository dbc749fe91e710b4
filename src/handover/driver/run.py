"""What came out of one simulated test."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from handover.generator.abstract_test import AbstractTest
    from handover.world.poses import Poses

SampleValue = bool | float | None
SampleValues = Mapping[str, SampleValue]

Observer = Callable[[int, SampleValues], None]
"""Called with each whole sample `(t_ns, values)` as soon as simulated time has passed it."""

AroundRobotStep = Callable[[], AbstractContextManager[object]]
"""Makes the context in which one step of the robot's code runs (for statement coverage)."""


@dataclass(frozen=True, slots=True)
class Run:
    """One simulated test, judged by nobody yet.

    Attributes:
        test: what was played.
        robot: `"correct"` or `"legacy"`.
        mutation: the change made to the robot, if any.
        samples: `(t_ns, values)`, strictly increasing, only what changed or occurred; events are
            `True`, a signal that is unknown is `None`; distances in m, speeds in m/s.
        states: `(t_ns, state)` at each entry of a robot state, also from itself (a poll).
        end_ns: the horizon.
        stepped_s: simulated seconds for which the physics was stepped.
        error: the exception of the robot's code as one text, if it crashed.
        poses: the scene over time, if asked for.
    """

    test: AbstractTest
    robot: str
    mutation: str | None
    samples: tuple[tuple[int, SampleValues], ...]
    states: tuple[tuple[int, str], ...]
    end_ns: int
    stepped_s: float
    error: str | None
    poses: Poses | None

    @property
    def simulated_s(self) -> float:
        """Simulated seconds, stepped or jumped."""
        return self.end_ns / 1e9
