"""Compute the figures of a campaign from the outcomes of its tests."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from rvmon.cdv import campaign_summary, code_coverage
from rvmon.cdv.campaign import unreachable_items
from rvmon.cdv.campaign_plan import Outcome, Played, Results
from rvmon.cdv.sequential_test import decide
from rvmon.coverage import STATES, TRANSITIONS, Ending, Group, model_of, without
from rvmon.language.checked.properties import BinKind
from rvmon.language.checked.specification import Requirement
from rvmon.report.verdict_table import Counts
from rvmon.session import Spec
from rvmon.verdicts import Verdict


def summarise(results: Results, specs: Mapping[str, Spec]) -> campaign_summary.CampaignSummary:
    """Count verdicts, statements, branches, states and transitions; without a spec, no verdicts."""
    campaign = results.plan.campaign
    measured = model_of(code_coverage.measured_groups(campaign))
    blocks = [] if campaign.code is None else [block.name for block in campaign.code.blocks]
    robots = {}
    for name, robot in campaign.robots.items():
        groups = without(measured, unreachable_items(campaign, name, measured)).groups
        requirements = {} if (spec := specs.get(name)) is None else spec.requirements
        played = [played for played in results.played if played.job.robot == name]
        by_strategy: dict[str, list[Played]] = {}
        for test_run in results.unmutated(name):
            by_strategy.setdefault(test_run.job.test.strategy, []).append(test_run)
        robots[name] = campaign_summary.RobotSummary(
            title=robot.title or name,
            spec=robot.spec_name or _display_path(robot.spec),
            requirements={key: one.text for key, one in requirements.items()},
            strategies={
                strategy: _strategy_summary(several, requirements, groups, blocks)
                for strategy, several in by_strategy.items()
            },
            controls={
                strategy: _counts(
                    (played.control or played.outcome for played in several), requirements
                )
                for strategy, several in by_strategy.items()
                if any(played.control is not None for played in several)
            },
            known=tuple(
                campaign_summary.KnownAnswer(
                    test,
                    test_run.outcome.verdicts,
                    campaign_summary.missed(test.reaches, test_run.outcome.hits),
                )
                for test_run in played
                if (test := test_run.job.test).expected or test.reaches
            ),
        )
    outcomes = [played.outcome for played in results.played]
    return campaign_summary.CampaignSummary(
        name=campaign.name,
        seed=results.plan.seed,
        robots=robots,
        planned=len(results.plan.jobs()),
        finished=len(outcomes),
        cut_short=results.cut_short,
        seconds=results.seconds,
        simulated_s=sum(outcome.simulated_s for outcome in outcomes),
        figures=_summed_figures(outcomes),
        kind="" if campaign.code is None else campaign.code.kind,
        control="" if campaign.control is None else campaign.control.name,
    )


def _display_path(path: str | Path | None) -> str:
    """A path, relative to the working directory if it is below it."""
    here = Path.cwd()
    if path is None or not Path(path).is_relative_to(here):
        return str(path or "")
    return str(Path(path).relative_to(here))


def _strategy_summary(
    played: Sequence[Played],
    requirements: Mapping[str, Requirement],
    groups: Mapping[str, Group],
    blocks: Sequence[str],
) -> campaign_summary.StrategySummary:
    outcomes = [test_run.outcome for test_run in played]
    statements, branches = (
        {
            block: _coverage(groups[name(block)], outcomes)
            for block in blocks
            if name(block) in groups
        }
        for name in (code_coverage.statements_name, code_coverage.branches_name)
    )
    return campaign_summary.StrategySummary(
        tests=len(outcomes),
        counts=_counts(outcomes, requirements),
        statements=statements,
        branches=branches,
        states=_tests_per_item(groups[STATES], outcomes),
        transitions={
            code_coverage.source_and_target(name): tests
            for name, tests in _tests_per_item(groups[TRANSITIONS], outcomes).items()
        },
        errors={
            ending: {
                test_run.job.test.name: test_run.outcome.error or ""
                for test_run in played
                if test_run.outcome.ending == ending
            }
            for ending in Ending
            if ending != Ending.COMPLETED
        },
        figures=_summed_figures(outcomes),
        simulated_s=sum(outcome.simulated_s for outcome in outcomes),
        shares={
            name: decide(requirement.run_share, _random_verdicts(name, played))
            for name, requirement in requirements.items()
            if requirement.run_share is not None
        },
    )


def _random_verdicts(requirement: str, played: Sequence[Played]) -> Iterator[Verdict]:
    """The verdicts of tests that state no expected one, as directed tests are no random samples."""
    for test_run in played:
        if requirement not in test_run.job.test.expected:
            yield test_run.outcome.verdicts[requirement]


def _counts(outcomes: Iterable[Outcome], requirements: Collection[str]) -> Mapping[str, Counts]:
    counts = {name: dict.fromkeys(Verdict, 0) for name in requirements}
    for outcome in outcomes:
        for name in requirements:
            counts[name][outcome.verdicts[name]] += 1
    return counts


def _tests_that_hit(group: str, outcomes: Sequence[Outcome]) -> Counter[str]:
    return Counter(item for outcome in outcomes for item in outcome.hits.get(group, ()))


def _tests_per_item(group: Group, outcomes: Sequence[Outcome]) -> dict[str, int]:
    """The number of tests that hit each item: first all goals, then other items that were hit."""
    return {**dict.fromkeys(_goals_of(group), 0), **_tests_that_hit(group.name, outcomes)}


def _coverage(group: Group, outcomes: Sequence[Outcome]) -> campaign_summary.BlockCoverage:
    hit = _tests_that_hit(group.name, outcomes)
    sought = _goals_of(group)
    missing = tuple(item for item in sought if item not in hit)
    return campaign_summary.BlockCoverage(len(sought), len(sought) - len(missing), missing)


def _goals_of(group: Group) -> list[str]:
    """The items that are goals."""
    return [name for name, item in group.items.items() if item.kind is BinKind.GOAL]


def _summed_figures(outcomes: Sequence[Outcome]) -> dict[str, float]:
    names = dict.fromkeys(name for outcome in outcomes for name in outcome.figures)
    return {name: sum(outcome.figures.get(name, 0) for outcome in outcomes) for name in names}
