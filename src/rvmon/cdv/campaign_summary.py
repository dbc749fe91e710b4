"""The figures of a campaign, as data."""

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
"""The states of the robot before and after."""


@dataclass(frozen=True, slots=True)
class BlockCoverage:
    """The coverage of a block's statements, or of its branches."""

    statements: int  # all statements, or branches
    covered: int  # the number that ran, or were taken
    missing: tuple[str, ...]  # the names of the others

    @property
    def percent(self) -> float:
        """The covered percentage; 0 and 100 only if exactly none or all are covered."""
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
    counts: Mapping[str, Counts]  # numbers of tests per verdict, by requirement
    statements: Mapping[str, BlockCoverage]  # by block; empty if no code is measured
    branches: Mapping[str, BlockCoverage]  # by block; empty if branches are not measured
    # The number of tests that entered each state, and took each transition; 0 for declared ones
    # that no test reached.
    states: Mapping[str, int]
    transitions: Mapping[Transition, int]
    errors: Mapping[Ending, Mapping[str, str]]  # why tests did not complete, by ending and test
    figures: Mapping[str, float]  # sums of the figures that the system reports of its runs
    simulated_s: float  # simulated seconds
    shares: Mapping[str, Decision]  # by requirement that must hold in a share of runs

    @property
    def total(self) -> BlockCoverage:
        """The coverage of the statements of all blocks."""
        return sum(self.statements.values(), NOTHING)


@dataclass(frozen=True, slots=True)
class KnownAnswer:
    """A directed test, which states its expected verdicts, with its outcome."""

    test: Test
    verdicts: Mapping[str, Verdict]  # of all requirements
    missed: Sequence[str]  # items that it aims at but did not reach, in words

    @property
    def wrong(self) -> list[str]:
        """The differences from what the test expects, a sentence each."""
        return [*differences(self.test.expected, self.verdicts), *self.missed]

    @property
    def as_expected(self) -> bool:
        """Whether the test had its expected verdicts and reached the items that it aims at."""
        return not self.wrong


def differences(expected: Mapping[str, str], verdicts: Mapping[str, Verdict]) -> list[str]:
    """The verdicts that differ from the expected ones, a sentence each.

    >>> differences({"R1": "F", "R2": "P"}, {"R1": Verdict.PASS, "R2": Verdict.PASS})
    ['R1 is P, not F']
    """
    return [
        f"{name} is {verdicts.get(name, 'no requirement')}, not {verdict}"
        for name, verdict in expected.items()
        if verdicts.get(name) != verdict
    ]


def missed(reaches: Mapping[str, Sequence[str]], hits: Hits) -> list[str]:
    """The items that a test aims at but did not reach, a sentence each.

    Without any hits the result is empty: then coverage was not measured.

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
    spec: str  # name of its specification
    requirements: Mapping[str, str]  # id → text; empty if nothing was judged
    strategies: Mapping[str, StrategySummary]  # without tests with a planted fault
    # Counts by strategy and requirement where each control replaces its test; only of strategies
    # with controls.
    controls: Mapping[str, Mapping[str, Counts]]
    known: tuple[KnownAnswer, ...]  # directed tests, including those with a planted fault


@dataclass(frozen=True, slots=True)
class CampaignSummary:
    """A whole campaign."""

    name: str  # of the campaign
    seed: int  # determines all tests
    robots: Mapping[str, RobotSummary]  # by name
    planned: int  # number of planned tests
    finished: int  # number of played tests
    cut_short: str  # why not all were played; empty if all were
    seconds: float  # wall time
    simulated_s: float  # simulated seconds of all tests
    figures: Mapping[str, float]  # sums of the figures that the systems report
    kind: str  # the word for a block of the measured code; empty if none is measured
    control: str  # the name of the controls; empty if there are none
