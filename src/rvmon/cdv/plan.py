"""What a campaign plays: tests by strategy, each against the robots that it is written for."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rvmon.cdv.abstract_test import Test
from rvmon.cdv.campaign import Campaign
from rvmon.cdv.files import TestError
from rvmon.errors import UnknownNameError

_FILE_NAME = re.compile(r"[^\W_][\w.+-]*", re.ASCII)


@dataclass(frozen=True, slots=True)
class Job:
    """One test against one robot.

    Attributes:
        test: what is played.
        robot: its name in the campaign.
    """

    test: Test
    robot: str


@dataclass(frozen=True, slots=True)
class Plan:
    """A campaign with its tests.

    Attributes:
        campaign: what it is about.
        seed: all tests follow from it.
        tests: by strategy.
    """

    campaign: Campaign
    seed: int
    tests: Mapping[str, Sequence[Test]]

    def jobs(self) -> list[Job]:
        """Every test against every robot that it is written for."""
        return [
            Job(test, robot)
            for robot in self.campaign.robots
            for tests in self.tests.values()
            for test in tests
            if test.robot in (None, robot)
        ]


def plan(
    campaign: Campaign, strategies: Sequence[str] = (), *, tests: int = 100, seed: int = 1
) -> Plan:
    """Generate the tests of a campaign.

    Args:
        campaign: what it is about.
        strategies: of its strategies those that make tests; default: all.
        tests: how many of each; one that has a fixed number of them makes those.
        seed: all tests follow from it.

    Raises:
        UnknownNameError: it has no such strategy.
        TestError: two tests have one name, or one has a name that no file can have.
    """
    known = ", ".join(campaign.strategies)
    for name in strategies:
        if name not in campaign.strategies:
            raise UnknownNameError(f"no strategy `{name}`: there are {known}")
    made = {
        name: campaign.strategies[name](tests, seed) for name in strategies or campaign.strategies
    }
    seen: set[str] = set()
    for test in (test for several in made.values() for test in several):
        if test.name in seen:
            raise TestError(f"two tests are called `{test.name}`: give each a name of its own")
        if not _FILE_NAME.fullmatch(test.name):
            raise TestError(
                f"test `{test.name}`: its file is called so: name it with letters, digits, - . + _"
            )
        seen.add(test.name)
    return Plan(campaign, seed, made)
