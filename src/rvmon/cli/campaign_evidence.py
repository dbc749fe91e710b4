"""Evidence of a campaign: its tests, with what they showed, and what played them."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.coverage import coverage_model
from rvmon.cdv.documents import to_json as document_json
from rvmon.cdv.execute import outcomes
from rvmon.cdv.files import from_json, to_json
from rvmon.cdv.outcome import Outcome, Results
from rvmon.cdv.plan import Job
from rvmon.cdv.summary import CampaignSummary
from rvmon.cdv.unfinished import sources_of
from rvmon.coverage.record import Ending
from rvmon.errors import RvmonError
from rvmon.evidence.about import About, Stamp, own_program, package_versions, stamp_of_files
from rvmon.evidence.keep import COVERAGE, Kept, Texts, coverage_json, texts_of, write_evidence
from rvmon.report.folder import refuse_no_file
from rvmon.session import Spec
from rvmon.verdict.rows import VerdictRow
from rvmon.verdict.verdict import Verdict


def begun(campaign: Campaign, path: str) -> Texts:
    """The requirements of a campaign as they are before it is played, and after.

    Args:
        campaign: that is to be played.
        path: where its evidence goes.

    Raises:
        RvmonError: evidence cannot be kept of it.
    """
    refuse_no_file(path)
    specs = {name: robot.spec for name, robot in campaign.robots.items() if robot.spec is not None}
    if len(specs) < len(campaign.robots):
        raise RvmonError("--evidence: nothing is judged: give each robot requirements")
    return texts_of(specs)


def write_campaign(
    path: str,
    before: Texts,
    results: Results,
    summary: CampaignSummary,
    specs: Mapping[str, Spec],
    words: Sequence[object],
) -> None:
    """Write the evidence of a campaign.

    Args:
        path: of the file.
        before: what `begun` gave before it was played.
        results: of its tests.
        summary: its figures.
        specs: what judged, by robot.
        words: the command that plays it again.

    Raises:
        RvmonError: it was interrupted, has changed meanwhile, or cannot be written.
    """
    campaign = results.plan.campaign
    if results.cut_short:
        raise RvmonError(f"--evidence: {results.cut_short}: evidence is of whole campaigns")
    if begun(campaign, path) != before:
        raise RvmonError("--evidence: requirements have changed meanwhile: run it again")
    jobs = {f"{one.job.robot}/{one.job.test.name}": one.job.test for one in results.played}
    about = About(
        name=campaign.name,
        packages=dict(package_versions(campaign.packages)),
        programs={"rvmon": own_program(), campaign.name: program_of(campaign)},
        specs=before.specs,
        command=[campaign.program or Path(sys.argv[0]).name, *map(str, words)],
        timeout_s=campaign.timeout_s,
        planted={name: test.mutation for name, test in jobs.items() if test.mutation is not None},
    )
    table = {**campaign.presentation.document(summary)}
    table.pop("seconds", None)  # those that it took
    covered = {
        robot: (
            coverage_model(campaign, robot),
            [
                one.outcome.hits
                for one in results.played
                if one.job.robot == robot and one.job.test.mutation is None
            ],
        )
        for robot in campaign.robots
    }
    entries = {
        **before.entries,
        **{f"tests/{test.name}.json": to_json(test) for test in jobs.values()},
        "table.json": document_json(table),
        COVERAGE: coverage_json(covered),
    }
    rows = (row for one in results.played for row in _rows(one.job, one.outcome))
    write_evidence(path, about, entries, specs, rows)


def program_of(campaign: Campaign) -> Stamp:
    """The stamp of what a campaign tests, and tests with."""
    paths = sources_of(campaign)
    return stamp_of_files(paths[0].parent, paths)


def _rows(job: Job, outcome: Outcome) -> Iterator[VerdictRow]:
    name = f"{job.robot}/{job.test.name}"
    error = "" if outcome.ending is Ending.COMPLETED else f"{outcome.ending}: {outcome.error}"
    for requirement, verdict in outcome.verdicts.items():
        reason = outcome.reasons.get(requirement, "")
        yield VerdictRow(name, requirement, verdict=verdict.value, reason=reason, error=error)
    for hit in outcome.illegal:
        yield VerdictRow(name, verdict=Verdict.FAIL.value, reason=hit)


def with_robots(campaign: Campaign, kept: Kept) -> Campaign:
    """The campaign as it made evidence: with its robots, judged by the requirements in there.

    Args:
        campaign: that made it.
        kept: the evidence.

    Raises:
        RvmonError: the campaign has no such robot.
    """
    specs = kept.specs
    if unknown := [name for name in specs if name not in campaign.robots]:
        raise RvmonError(f"{campaign.name} has no robot {', '.join(unknown)}: is it the campaign?")
    robots = {name: replace(campaign.robots[name], spec=spec) for name, spec in specs.items()}
    return replace(campaign, robots=robots, timeout_s=kept.about.timeout_s)


def played_again(
    campaign: Campaign, kept: Kept, chosen: Sequence[str], jobs: int
) -> Iterator[VerdictRow]:
    """Play tests of evidence again; their code is not measured.

    Args:
        campaign: of `with_robots`.
        kept: the evidence.
        chosen: robots and tests.
        jobs: processes.
    """
    own = replace(campaign, code=None)
    tests = [_job(own, kept, name) for name in chosen]
    played = outcomes(own, tests, jobs=jobs, controls=False)
    for job, (outcome, _) in zip(tests, played, strict=True):
        yield from _rows(job, outcome)


def _job(campaign: Campaign, kept: Kept, name: str) -> Job:
    """A test of evidence on its robot.

    Raises:
        RvmonError: there is no such robot, or no such test.
    """
    robot, _, test = name.partition("/")
    entry = f"tests/{test}.json"
    if robot not in campaign.robots or entry not in kept.entries:
        raise RvmonError(f"{campaign.name} has no robot `{robot}`, or the evidence no `{entry}`")
    return Job(from_json(kept.entries[entry], campaign.test, source=entry), robot)
