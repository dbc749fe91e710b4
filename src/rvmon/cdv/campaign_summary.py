"""The figures of a campaign: data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rvmon.cdv.sequential_test import Decision
from rvmon.cdv.test import Test
from rvmon.coverage import Ending, Hits
from rvmon.report.verdict_table import Counts
from rvmon.texts import percent
from rvmon.verdicts import Verdict

Transition = tuple[str, str]
"""From one state of the robot to another."""


@dataclass(frozen=True, slots=True)
class BlockCoverage:
    """The number of statements of a block of code that ran, or of its branches that were taken."""

    statements: int
    covered: int
    missing: tuple[str, ...]

    @property
    def percent(self) -> float:
        """The share of `covered`; 0 and 100 only where exactly none or all have run."""
        return percent(self.covered, self.statements)

    def __add__(self, other: BlockCoverage) -> BlockCoverage:
        return BlockCoverage(
            self.statements + other.statements,
            self.covered + other.covered,
            self.missing + other.missing,
        )


NOTHING = BlockCoverage(0, 0, ())
"""The coverage of no code."""


@dataclass(frozen=True, slots=True)
class StrategySummary:
    """All tests of one strategy against one robot."""

    tests: int  # the number played
    counts: Mapping[str, Counts]  # of tests per verdict, by requirement
    # of the measured code, by block; empty if none is measured
    statements: Mapping[str, BlockCoverage]
    branches: Mapping[str, BlockCoverage]  # by block; empty if they are not measured
    # the number of tests that entered each; declared ones also if none did
    states: Mapping[str, int]
    transitions: Mapping[Transition, int]  # the number of tests that took each, likewise
    # by how tests ended that did not complete, why, by test
    errors: Mapping[Ending, Mapping[str, str]]
    figures: Mapping[str, float]  # the sums of what the system reports of its runs
    simulated_s: float  # simulated seconds
    # by requirement that is to hold in a share of runs, what the tests say of it
    shares: Mapping[str, Decision]

    @property
    def total(self) -> BlockCoverage:
        """Statements of all blocks."""
        return sum(self.statements.values(), NOTHING)


@dataclass(frozen=True, slots=True)
class KnownAnswer:
    """A directed test: it knows what is to come out."""

    test: Test  # itself
    verdicts: Mapping[str, Verdict]  # of all requirements
    missed: Sequence[str]  # the items that it aims at and did not reach, in words

    @property
    def wrong(self) -> list[str]:
        """The differences from the test's expectations, a sentence each."""
        return [*differences(self.test.expected, self.verdicts), *self.missed]

    @property
    def as_expected(self) -> bool:
        """Whether all expected verdicts came out, in the situation that it is about."""
        return not self.wrong


def differences(expected: Mapping[str, str], verdicts: Mapping[str, Verdict]) -> list[str]:
    """The verdicts that differ from a test's expectations, a sentence each.

    >>> differences({"R1": "F", "R2": "P"}, {"R1": Verdict.PASS, "R2": Verdict.PASS})
    ['R1 is P, not F']
    """
    return [
        f"{name} is {verdicts.get(name, 'no requirement')}, not {verdict}"
        for name, verdict in expected.items()
        if verdicts.get(name) != verdict
    ]


def missed(reaches: Mapping[str, Sequence[str]], hits: Hits) -> list[str]:
    """The items that a test aims at and missed, a sentence each; empty if none was measured.

    >>> from rvmon.coverage import Hit
    >>> missed({"gaze": ["no"]}, {"gaze": {"yes": Hit(1)}})
    ['gaze: no is not reached']
    """
    return [
        f"{group}: {item} is not reached"
        for group, items in (reaches if hits else {}).items()
        for item in items
        if item not in hits.get(group, {})
    ]


@dataclass(frozen=True, slots=True)
class RobotSummary:
    """One robot under all strategies."""

    title: str  # its name in tables
    spec: str  # name of the requirements' file
    requirements: Mapping[str, str]  # id → text; empty if nothing was judged
    strategies: Mapping[str, StrategySummary]  # without the tests on mutated robots
    # counts by strategy and requirement with the controls in the place of their tests, of the
    # strategies that have some
    controls: Mapping[str, Mapping[str, Counts]]
    # directed tests with their answers, also those on mutated robots
    known: tuple[KnownAnswer, ...]


@dataclass(frozen=True, slots=True)
class CampaignSummary:
    """A whole campaign."""

    name: str  # of the campaign
    seed: int  # all tests follow from it
    robots: Mapping[str, RobotSummary]  # by name
    planned: int  # the number of planned tests
    finished: int  # the number of played ones
    cut_short: str  # why fewer; empty if all were
    seconds: float  # wall time
    simulated_s: float  # simulated seconds, in all tests
    figures: Mapping[str, float]  # the sums of what the systems report of all runs
    kind: str  # the word for a block of the measured code
    control: str  # the name of the variant that was played with each test
