"""The coverage models by which a robot's runs are watched, beside what judges them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rvmon.cdv.campaign import Robot
from rvmon.loading import load

if TYPE_CHECKING:
    from rvmon.coverage.model import Model
    from rvmon.coverage.monitor import CoverageMonitor
    from rvmon.session import Spec


@dataclass(frozen=True, slots=True)
class Watch:
    """The coverage model of a specification, or the part of it that is watched.

    Attributes:
        spec: the specification.
        requirements: whether what its requirements show is watched as well as its coverpoints.
    """

    spec: Spec
    requirements: bool

    @property
    def model(self) -> Model:
        """What may be hit."""
        model = self.spec.coverage_model
        return model.model if self.requirements else model.bin_model

    def monitor(self) -> CoverageMonitor:
        """What watches runs."""
        return self.spec.coverage_model.monitor(requirements=self.requirements)


def watches_of(robot: Robot, spec: Spec, *, everything: bool) -> list[Watch]:
    """By what a robot's runs are watched.

    Args:
        robot: the robot.
        spec: its requirements.
        everything: all that its coverage models have; else only its requirements' coverpoints,
            as some must not be hit.
    """
    found = []
    if everything or spec.checked.coverpoints:
        found.append(Watch(spec, everything))
    if everything and robot.situations is not None:
        found.append(Watch(load(robot.situations), requirements=True))
    return found
