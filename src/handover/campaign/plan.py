"""What a campaign plays: tests by strategy, robots, and the requirements that judge them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from handover.campaign.strategies import STRATEGIES
from handover.checker import spec_path
from handover.generator.abstract_test import AbstractTest


@dataclass(frozen=True, slots=True)
class Job:
    """One test against one robot.

    Attributes:
        test: what is played.
        robot: `correct` or `legacy`.
        startup_loss: `False` plays it without the fitted loss of signals.
    """

    test: AbstractTest
    robot: str
    startup_loss: bool = True


@dataclass(frozen=True, slots=True)
class Plan:
    """A whole campaign.

    Attributes:
        seed: all tests follow from it.
        tests: by strategy.
        specs: by robot, the file of its requirements.
        monitors: `False` judges nothing, to measure what judging costs.
    """

    seed: int
    tests: Mapping[str, Sequence[AbstractTest]]
    specs: Mapping[str, Path]
    monitors: bool = True

    def jobs(self) -> list[Job]:
        """Every test against every robot that it is written for."""
        return [
            Job(test, robot)
            for robot in self.specs
            for tests in self.tests.values()
            for test in tests
            if test.robot in (None, robot)
        ]


def plan(
    robots: Sequence[str],
    strategies: Sequence[str],
    *,
    tests: int = 100,
    seed: int = 1,
    spec: Path | None = None,
    monitors: bool = True,
) -> Plan:
    """Generate the tests of a campaign.

    Args:
        robots: `correct`, `legacy` or both.
        strategies: keys of `STRATEGIES`.
        tests: how many of each random strategy.
        seed: of the campaign.
        spec: judges all robots; default: each robot's own requirements.
        monitors: whether anything is judged.
    """
    return Plan(
        seed,
        {name: STRATEGIES[name](tests, seed) for name in strategies},
        {robot: spec or spec_path(robot) for robot in robots},
        monitors,
    )
