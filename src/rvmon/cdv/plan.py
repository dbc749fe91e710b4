"""What a campaign plays: tests by strategy, each against the robots that it is written for."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rvmon.cdv.abstract_test import Test
from rvmon.cdv.campaign import Campaign
from rvmon.cdv.files import TestError, from_json, load, to_json
from rvmon.errors import RvmonError, UnknownNameError

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
        TestError: a strategy fails, a test cannot be written to a file and read back, two have one
            name, or a name is none of a file.
    """
    known = ", ".join(campaign.strategies)
    for name in strategies:
        if name not in campaign.strategies:
            raise UnknownNameError(f"no strategy `{name}`: there are {known}")
    made = {name: _made(campaign, name, tests, seed) for name in strategies or campaign.strategies}
    _refuse_names(campaign, [test for several in made.values() for test in several])
    return Plan(campaign, seed, made)


def plan_of_folder(campaign: Campaign, folder: str | Path) -> Plan:
    """The tests of a folder as those of a campaign, such as a suite that was closed before.

    Args:
        campaign: what it is about.
        folder: with a `.json` file for each.

    Raises:
        TestError: there is no test in it, one is none of the campaign, or two have one name.
    """
    paths = sorted(Path(folder).glob("*.json"))
    if not paths:
        raise TestError(f"{folder}: no test (.json) in this folder: name one that `--out` wrote")
    tests = [load(path, campaign.test) for path in paths]
    _refuse_names(campaign, tests)
    made: dict[str, list[Test]] = {}
    for test in tests:
        made.setdefault(test.strategy, []).append(test)
    return Plan(campaign, 0, made)


def _refuse_names(campaign: Campaign, tests: Sequence[Test]) -> None:
    """See that files can be called as tests and robots are.

    Raises:
        TestError: two tests have one name, or a name is none of a file.
    """
    seen: set[str] = set()
    for test in tests:
        if test.name.lower() in seen:  # some systems take names for one that differ in case only
            raise TestError(f"two tests are called `{test.name}`: give each a name of its own")
        seen.add(test.name.lower())
    for name in (*campaign.robots, *(test.name for test in tests)):
        if not _FILE_NAME.fullmatch(name):
            raise TestError(f"`{name}`: a file is called so: use letters, digits, - . + _ only")


def _made(campaign: Campaign, strategy: str, tests: int, seed: int) -> list[Test]:
    """The tests of a strategy."""
    try:
        made = [*campaign.strategies[strategy](tests, seed)]
    except RvmonError:
        raise
    except Exception as error:
        cause = f"{type(error).__name__}: {error}"
        raise TestError(f"strategy `{strategy}` cannot make its tests: {cause}") from error
    for test in made:
        if not isinstance(test, campaign.test):
            kind = campaign.test.__name__
            raise TestError(f"strategy `{strategy}` makes {test!r}, which is no {kind}")
        if test.strategy != strategy:
            raise TestError(
                f"test `{test.name}` of strategy `{strategy}` names another strategy, "
                f"`{test.strategy}`"
            )
        from_json(to_json(test), campaign.test, source=f"test `{test.name}` of `{strategy}`")
    return made
