"""The plan of a campaign: its tests; and its results: the outcome of each test."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rvmon.cdv.campaign import Campaign, ExpectedFailure
from rvmon.cdv.test import Test, TestError, blamed, from_json, load, to_json
from rvmon.coverage import Ending, Group, Hits
from rvmon.errors import UnknownNameError
from rvmon.verdicts import Verdict

_FILE_NAME = re.compile(r"[^\W_][\w.+-]*", re.ASCII)


@dataclass(frozen=True, slots=True)
class Job:
    """One test against one robot."""

    test: Test
    robot: str


@dataclass(frozen=True, slots=True)
class Plan:
    """A campaign with its tests."""

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
        campaign: the campaign.
        strategies: the strategies that make tests; default: all.
        tests: the number of tests per strategy; a strategy may have a fixed number and ignore it.
        seed: determines all tests.

    Raises:
        UnknownNameError: the campaign has no such strategy.
        TestError: a strategy fails, a test cannot be written to a file and read back, two tests
            have the same name, or a name cannot be a file name.
    """
    known = ", ".join(campaign.strategies)
    for name in strategies:
        if name not in campaign.strategies:
            raise UnknownNameError(f"no strategy `{name}`: there are {known}")
    names = strategies or campaign.strategies
    generated = {name: _generate(campaign, name, tests, seed) for name in names}
    _check_names(campaign, [test for several in generated.values() for test in several])
    return Plan(campaign, seed, generated)


def plan_of_folder(campaign: Campaign, folder: str | Path) -> Plan:
    """A plan of the tests in a folder, such as a suite that `close` wrote.

    Raises:
        TestError: the folder has no test, a file is not a test of this campaign, or two tests have
            the same name.
    """
    paths = sorted(Path(folder).glob("*.json"))
    if not paths:
        raise TestError(f"{folder}: no test (.json) in this folder: name one that `--out` wrote")
    tests = [load(path, campaign.test) for path in paths]
    _check_names(campaign, tests)
    by_strategy: dict[str, list[Test]] = {}
    for test in tests:
        by_strategy.setdefault(test.strategy, []).append(test)
    return Plan(campaign, 0, by_strategy)


def _check_names(campaign: Campaign, tests: Sequence[Test]) -> None:
    """Check that the names of tests and robots can be file names.

    Raises:
        TestError: two tests have the same name, or a name cannot be a file name.
    """
    seen: set[str] = set()
    for test in tests:
        if test.name.lower() in seen:  # some file systems ignore case
            raise TestError(f"two tests are called `{test.name}`: give each a name of its own")
        seen.add(test.name.lower())
    for name in (*campaign.robots, *(test.name for test in tests)):
        if not _FILE_NAME.fullmatch(name):
            raise TestError(f"`{name}` cannot be a file name: use letters, digits, - . + _ only")


def _generate(campaign: Campaign, strategy: str, tests: int, seed: int) -> list[Test]:
    with blamed(f"strategy `{strategy}` cannot make its tests"):
        generated = [*campaign.strategies[strategy](tests, seed)]
    for test in generated:
        if not isinstance(test, campaign.test):
            kind = campaign.test.__name__
            raise TestError(f"strategy `{strategy}` makes {test!r}, which is not a {kind}")
        if test.strategy != strategy:
            raise TestError(
                f"test `{test.name}` of strategy `{strategy}` names another strategy, "
                f"`{test.strategy}`"
            )
        # A test that cannot be read back could not be replayed: find out before hours of playing.
        from_json(to_json(test), campaign.test, source=f"test `{test.name}` of `{strategy}`")
    return generated


@dataclass(frozen=True, slots=True)
class Outcome:
    """The outcome of one test."""

    # By requirement; empty if nothing was judged. All are inconclusive if the test hung or was
    # lost, as then no report exists.
    verdicts: Mapping[str, Verdict]
    reasons: Mapping[str, str]  # of each failed requirement, its first failure in words
    illegal: tuple[str, ...]  # hits of illegal bins, in words
    hits: Hits  # of states, transitions, code and coverage models
    # A crashed test (its code raised an exception) is judged as far as it ran; a hung test was
    # killed at the timeout; the process of a lost test ended on its own.
    ending: Ending
    error: str | None  # why it did not complete
    end_ns: int  # the instant up to which it was judged
    figures: Mapping[str, float]  # reported by the system, to be added up
    seconds: float = field(compare=False)  # wall time

    @property
    def simulated_s(self) -> float:
        """Simulated seconds."""
        return self.end_ns / 1e9


@dataclass(frozen=True, slots=True)
class Played:
    """A played test."""

    job: Job
    outcome: Outcome
    control: Outcome | None = None


@dataclass(frozen=True, slots=True)
class Results:
    """The results of a campaign."""

    plan: Plan
    played: tuple[Played, ...]  # in the order of the plan
    seconds: float  # wall time
    cut_short: str = ""  # why not all tests were played; empty if all were
    groups: Sequence[Group] = ()  # coverage groups beyond those of the campaign
    # Reasons why items cannot be hit, by group and item, beyond those that the campaign names.
    unreachable: Mapping[tuple[str, str], str] = field(default_factory=dict)

    def unmutated(self, robot: str) -> list[Played]:
        """The tests of a robot without a planted fault: only these tell something about it."""
        own = (played for played in self.played if played.job.robot == robot)
        return [played for played in own if played.job.test.mutation is None]


def accepted_failures(played: Played, expected: Sequence[ExpectedFailure]) -> dict[str, str]:
    """The requirements whose failure in a test is accepted, each with the reason."""
    accepted = {
        name: "this test is made to fail it"
        for name, verdict in played.job.test.expected.items()
        if verdict == Verdict.FAIL.value
    }
    for why in expected:
        if applies_to(why, played):
            accepted.setdefault(why.requirement, why.reason)
    return accepted


def applies_to(why: ExpectedFailure, played: Played) -> bool:
    """Whether an expected failure applies to a test; never to one with a planted fault."""
    test = played.job.test
    return (
        test.mutation is None
        and why.strategy in ("", test.strategy)
        and why.test in ("", test.name)
        and why.robot in ("", played.job.robot)
    )
