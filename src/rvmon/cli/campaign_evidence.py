"""Evidence of a campaign: its tests, their verdicts, and the versions of all programs."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rvmon import evidence
from rvmon.cdv.campaign import Campaign
from rvmon.cdv.campaign_plan import Job, Outcome, Results
from rvmon.cdv.campaign_summary import CampaignSummary
from rvmon.cdv.coverage import coverage_model
from rvmon.cdv.play import outcomes
from rvmon.cdv.resume import sources_of
from rvmon.cdv.tables import to_json as document_json
from rvmon.cdv.test import from_json, to_json
from rvmon.coverage import Ending
from rvmon.errors import RvmonError
from rvmon.files import refuse_no_file
from rvmon.session import Spec
from rvmon.verdicts.serialise import VerdictRow


def requirement_texts(campaign: Campaign, path: str) -> tuple[dict[str, bytes], list[str]]:
    """The archive entries of all requirements; read before and after the campaign is played."""
    refuse_no_file(path)
    specs = {name: robot.spec for name, robot in campaign.robots.items() if robot.spec is not None}
    if len(specs) < len(campaign.robots):
        raise RvmonError("--evidence: there is nothing to check: give each robot requirements")
    return evidence.texts_of(specs)


def write_campaign(
    path: str,
    before: tuple[dict[str, bytes], list[str]],
    results: Results,
    summary: CampaignSummary,
    specs: Mapping[str, Spec],
    words: Sequence[object],
) -> None:
    """Write the evidence of a campaign.

    `before` is what `requirement_texts` returned before the campaign; `words` are its command line.

    Raises:
        RvmonError: the requirements have changed since, or the file cannot be written.
    """
    campaign = results.plan.campaign
    if requirement_texts(campaign, path) != before:
        raise RvmonError("--evidence: requirements have changed meanwhile: run the command again")
    tests = {_name(played.job): played.job.test for played in results.played}
    about = evidence.About(
        name=campaign.name,
        packages=evidence.package_versions(campaign.packages),
        programs={"rvmon": evidence.own_program()} | programs_of(campaign),
        specs=dict(zip(specs, before[1], strict=True)),
        command=[campaign.program or Path(sys.argv[0]).name, *map(str, words)],
        timeout_s=campaign.timeout_s,
        planted={name: test.mutation for name, test in tests.items() if test.mutation is not None},
    )
    covered = {
        robot: (
            coverage_model(campaign, robot),
            [played.outcome.hits for played in results.unmutated(robot)],
        )
        for robot in campaign.robots
    }
    table = {**campaign.presentation.document(summary)}
    table.pop("seconds", None)  # the duration would make equal runs differ
    entries = {
        **before[0],
        **{f"tests/{test.name}.json": to_json(test) for test in tests.values()},
        "table.json": document_json(table),
        evidence.COVERAGE: evidence.coverage_json(covered),
    }
    rows = (row for played in results.played for row in _rows(played.job, played.outcome))
    evidence.write_evidence(path, about, entries, specs, rows)


def programs_of(campaign: Campaign) -> dict[str, str]:
    """SHA-256, by name, of the folders and files that the outcomes of a campaign depend on."""
    return {
        path.name if path.is_dir() else f"{path.parent.name}/{path.name}": evidence.sha256_of(path)
        for path in sources_of(campaign)
    }


def _name(job: Job) -> str:
    return f"{job.robot}/{job.test.name}"


def _rows(job: Job, outcome: Outcome) -> Iterator[VerdictRow]:
    name = _name(job)
    error = "" if outcome.ending is Ending.COMPLETED else f"{outcome.ending}: {outcome.error}"
    for requirement, verdict in outcome.verdicts.items():
        reason = outcome.reasons.get(requirement, "")
        yield VerdictRow(name, requirement, verdict=verdict.value, reason=reason, error=error)
    for hit in outcome.illegal:
        yield VerdictRow(name, verdict="F", reason=hit)


def as_kept(campaign: Campaign, kept: evidence.Kept) -> Campaign:
    """The campaign with the robots, requirements and timeout of its evidence."""
    if unknown := kept.specs.keys() - campaign.robots.keys():
        raise RvmonError(f"{campaign.name} has no robot {', '.join(sorted(unknown))}")
    robots = {name: replace(campaign.robots[name], spec=spec) for name, spec in kept.specs.items()}
    return replace(campaign, robots=robots, timeout_s=kept.about.timeout_s)


def played_again(
    campaign: Campaign, kept: evidence.Kept, chosen: Sequence[str], jobs: int
) -> Iterator[VerdictRow]:
    """Play the chosen tests of evidence again, without measuring code coverage."""
    tests = []
    for name in chosen:
        robot, _, test = name.partition("/")
        entry = f"tests/{test}.json"
        body = kept.entries.get(entry, b"")
        tests.append(Job(from_json(body, campaign.test, source=entry), robot))
    played = outcomes(replace(campaign, code=None), tests, jobs=jobs, controls=False)
    for job, (outcome, _) in zip(tests, played, strict=True):
        yield from _rows(job, outcome)
