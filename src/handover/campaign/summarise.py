"""Outcomes of tests become the figures of a campaign."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise

from handover.campaign.outcome import Outcome, Results
from handover.campaign.summary import (
    CampaignSummary,
    KnownAnswer,
    RobotSummary,
    StrategySummary,
)
from handover.checker import SPECS
from handover.checker.specs import spec_path
from handover.collector.meter import robot_statements
from handover.collector.statements import Statements, coverage_by_state, total_coverage
from rvmon.report.table import Counts
from rvmon.verdict.verdict import Verdict


def summarise(
    results: Results,
    requirements: Mapping[str, Mapping[str, str]],
    checked: Mapping[str, bool | None] | None = None,
) -> CampaignSummary:
    """Count verdicts, statements and transitions.

    Args:
        results: what was played.
        requirements: by robot, id → text of what it was judged by.
        checked: what model checking says by requirement, if it was asked.
    """
    plan = results.plan
    statements = robot_statements()
    robots = {}
    for robot, spec in plan.specs.items():
        names = tuple(requirements[robot])
        outcomes = [one for one in results.outcomes if one.job.robot == robot]
        repeated = [one for one in results.unfitted if one.job.robot == robot]
        robots[robot] = RobotSummary(
            spec=SPECS[robot] if spec == spec_path(robot) else str(spec),
            requirements=requirements[robot],
            strategies={
                strategy: _strategy(group, names, statements)
                for strategy, group in _by_strategy(outcomes).items()
            },
            unfitted={
                strategy: _counts(group, names)
                for strategy, group in _by_strategy(_replaced(outcomes, repeated)).items()
                if any(one.job.test.strategy == strategy for one in repeated)
            },
            known=tuple(_known(one) for one in outcomes if one.job.test.expected),
        )
    return CampaignSummary(
        seed=plan.seed,
        robots=robots,
        checked=checked or {},
        planned=len(plan.jobs()),
        finished=len(results.outcomes),
        cut_short=results.cut_short,
        seconds=results.seconds,
        stepped_s=sum(one.stepped_s for one in results.outcomes),
        simulated_s=sum(one.simulated_s for one in results.outcomes),
    )


def _by_strategy(outcomes: Sequence[Outcome]) -> dict[str, list[Outcome]]:
    """Outcomes on the robot as it is: a planted fault says nothing about the robot."""
    groups: dict[str, list[Outcome]] = {}
    for one in outcomes:
        if one.job.test.mutation is None:
            groups.setdefault(one.job.test.strategy, []).append(one)
    return groups


def _replaced(outcomes: Sequence[Outcome], repeated: Sequence[Outcome]) -> list[Outcome]:
    again = {one.job.test.name: one for one in repeated}
    return [again.get(one.job.test.name, one) for one in outcomes]


def _strategy(
    outcomes: Sequence[Outcome], requirements: Sequence[str], statements: Statements
) -> StrategySummary:
    executed = frozenset().union(*(one.lines for one in outcomes))
    transitions = Counter(
        transition for one in outcomes for transition in dict.fromkeys(pairwise(one.states))
    )
    return StrategySummary(
        tests=len(outcomes),
        counts=_counts(outcomes, requirements),
        statements=coverage_by_state(statements, executed),
        total=total_coverage(statements, executed),
        transitions=transitions,
        crashes={one.job.test.name: one.error for one in outcomes if one.error is not None},
        stepped_s=sum(one.stepped_s for one in outcomes),
        simulated_s=sum(one.simulated_s for one in outcomes),
    )


def _counts(outcomes: Sequence[Outcome], requirements: Sequence[str]) -> dict[str, Counts]:
    counts: dict[str, Counts] = {}
    for name in requirements:
        seen = Counter(one.verdicts[name] for one in outcomes)
        counts[name] = {verdict: seen[verdict] for verdict in Verdict}
    return counts


def _known(outcome: Outcome) -> KnownAnswer:
    test = outcome.job.test
    return KnownAnswer(test.name, test.text, test.mutation, test.expected, outcome.verdicts)
