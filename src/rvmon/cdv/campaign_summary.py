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
    """All tests of one strategy against one robot.

    Attributes:
        tests: the number played.
        counts: of tests per verdict, by requirement.
        statements: of the measured code, by block; empty if none is measured.
        branches: by block; empty if they are not measured.
        states: the number of tests that entered each; declared ones also if none did.
        transitions: the number of tests that took each, likewise.
        errors: by how tests ended that did not complete, why, by test.
        figures: the sums of what the system reports of its runs.
        simulated_s: simulated seconds.
        shares: by requirement that is to hold in a share of runs, what the tests say of it.
    """

    tests: int
    counts: Mapping[str, Counts]
    statements: Mapping[str, BlockCoverage]
    branches: Mapping[str, BlockCoverage]
    states: Mapping[str, int]
    transitions: Mapping[Transition, int]
    errors: Mapping[Ending, Mapping[str, str]]
    figures: Mapping[str, float]
    simulated_s: float
    shares: Mapping[str, Decision]

    @property
    def total(self) -> BlockCoverage:
        """Statements of all blocks."""
        return sum(self.statements.values(), NOTHING)


@dataclass(frozen=True, slots=True)
class KnownAnswer:
    """A directed test: it knows what is to come out.

    Attributes:
        test: itself.
        verdicts: of all requirements.
        missed: the items that it aims at and did not reach, in words.
    """

    test: Test
    verdicts: Mapping[str, Verdict]
    missed: Sequence[str]

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
    """One robot under all strategies.

    Attributes:
        title: its name in tables.
        spec: name of the requirements' file.
        requirements: id → text; empty if nothing was judged.
        strategies: without the tests on mutated robots.
        controls: counts by strategy and requirement with the controls in the place of their tests,
            of the strategies that have some.
        known: directed tests with their answers, also those on mutated robots.
    """

    title: str
    spec: str
    requirements: Mapping[str, str]
    strategies: Mapping[str, StrategySummary]
    controls: Mapping[str, Mapping[str, Counts]]
    known: tuple[KnownAnswer, ...]


@dataclass(frozen=True, slots=True)
class CampaignSummary:
    """A whole campaign.

    Attributes:
        name: of the campaign.
        seed: all tests follow from it.
        robots: by name.
        planned: the number of planned tests.
        finished: the number of played ones.
        cut_short: why fewer; empty if all were.
        seconds: wall time.
        simulated_s: simulated seconds, in all tests.
        figures: the sums of what the systems report of all runs.
        kind: the word for a block of the measured code.
        control: the name of the variant that was played with each test.
    """

    name: str
    seed: int
    robots: Mapping[str, RobotSummary]
    planned: int
    finished: int
    cut_short: str
    seconds: float
    simulated_s: float
    figures: Mapping[str, float]
    kind: str
    control: str
