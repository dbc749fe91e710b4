"""The figures of a campaign: data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from handover.collector.statements import StatementCoverage
from rvmon.report.table import Counts
from rvmon.verdict.verdict import Verdict

Transition = tuple[str, str]
"""From one state of the robot to another."""


@dataclass(frozen=True, slots=True)
class StrategySummary:
    """All tests of one strategy against one robot.

    Attributes:
        tests: how many were finished.
        counts: of tests per verdict, by requirement.
        statements: of the robot's code, by state.
        total: of the robot's code.
        transitions: how many tests took each.
        crashes: what the robot's code raised, by test.
        stepped_s: simulated seconds for which the physics was stepped.
        simulated_s: simulated seconds in all.
    """

    tests: int
    counts: Mapping[str, Counts]
    statements: Mapping[str, StatementCoverage]
    total: StatementCoverage
    transitions: Mapping[Transition, int]
    crashes: Mapping[str, str]
    stepped_s: float
    simulated_s: float


@dataclass(frozen=True, slots=True)
class KnownAnswer:
    """A directed test that knows what is to come out.

    Attributes:
        test: its name.
        text: what it is for.
        mutation: the fault that was planted into the robot, if any.
        expected: verdicts by requirement.
        verdicts: what came out, of all requirements.
    """

    test: str
    text: str
    mutation: str | None
    expected: Mapping[str, str]
    verdicts: Mapping[str, Verdict]

    @property
    def as_expected(self) -> bool:
        """Whether all expected verdicts came out."""
        return all(self.verdicts.get(name) == verdict for name, verdict in self.expected.items())


@dataclass(frozen=True, slots=True)
class RobotSummary:
    """One robot under all strategies.

    Attributes:
        spec: name of the requirements' file.
        requirements: id → text; empty if nothing was judged.
        strategies: without the tests on mutated robots.
        unfitted: counts by strategy and requirement without the fitted loss of signals, of the
            strategies in which signals got lost.
        known: directed tests with their answers, also those on mutated robots.
    """

    spec: str
    requirements: Mapping[str, str]
    strategies: Mapping[str, StrategySummary]
    unfitted: Mapping[str, Mapping[str, Counts]]
    known: tuple[KnownAnswer, ...]


@dataclass(frozen=True, slots=True)
class CampaignSummary:
    """A whole campaign.

    Attributes:
        seed: of the campaign.
        robots: by name.
        checked: what model checking says by requirement, `None` if the model cannot express it;
            empty if it was not asked.
        planned: how many tests were to be played.
        finished: how many were.
        cut_short: why fewer; empty if all were.
        seconds: wall time.
        stepped_s: simulated seconds for which the physics was stepped, in all tests.
        simulated_s: simulated seconds in all.
    """

    seed: int
    robots: Mapping[str, RobotSummary]
    checked: Mapping[str, bool | None]
    planned: int
    finished: int
    cut_short: str
    seconds: float
    stepped_s: float
    simulated_s: float
