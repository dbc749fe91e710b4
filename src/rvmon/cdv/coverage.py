"""The coverage of a campaign's tests, collected while they are played, and stored."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec.structs import replace

from rvmon.cdv.campaign import unreachable_items
from rvmon.cdv.campaign_plan import accepted_failures
from rvmon.cdv.code_coverage import cobertura, lcov, measured_groups
from rvmon.coverage import Group, Item, Model, TestRecord, merged, model_of, share, without
from rvmon.coverage.database import Database, read
from rvmon.errors import RvmonError
from rvmon.files import write_whole
from rvmon.language.checked.properties import BinKind
from rvmon.report.coverage_page import coverage_page
from rvmon.report.coverage_summary import Summary

if TYPE_CHECKING:
    from rvmon.cdv.campaign import Campaign, Robot
    from rvmon.cdv.campaign_plan import Played, Results


@dataclass(frozen=True, slots=True)
class CoverageFigures:
    """The coverage of one robot's tests."""

    page: str  # its address in the campaign's folder
    share: float  # of the model, from 0 to 1
    holes: int  # items that were not hit as often as they have to be
    illegal: tuple[str, ...]  # hits of items that must not be hit


DATABASE = "coverage.db"
"""The file in a campaign's folder; of several robots, each has one in a folder of its name."""

LCOV, COBERTURA = "code.lcov", "cobertura.xml"
"""The same of the code alone, beside it."""


def coverage_model(campaign: Campaign, robot: str) -> Model:
    """All that the tests of a robot are to show.

    Raises:
        RvmonError: two of its specifications call something the same.
    """
    groups = measured_groups(campaign)
    for coverage in campaign.robots[robot].coverages:
        groups += coverage.model.groups.values()
    try:
        return model_of(groups)
    except ValueError as error:
        raise RvmonError(
            f"robot `{robot}`: {error}: its requirements, coverpoints, crosses and goals need "
            "names of their own; states, transitions and blocks of code have theirs"
        ) from None


def covered_share(campaign: Campaign, robot: str, played: Sequence[Played]) -> float:
    """The share of what tests of a robot can show that some of them have shown, from 0 to 1.

    Raises:
        RvmonError: see `coverage_model`.
        UnknownNameError: the campaign calls unreachable what there is not.
    """
    model = coverage_model(campaign, robot)
    out = unreachable_items(campaign, robot, model)
    return share(merged(test_run.outcome.hits for test_run in played), without(model, out))


def write_database(path: Path, robot: str, played: Sequence[Played], results: Results) -> None:
    """Write the database of those of a robot's tests that count; one that is there is replaced.

    Raises:
        RvmonError: the file cannot be written, or see `coverage_model`.
    """
    campaign = results.plan.campaign
    model = coverage_model(campaign, robot)
    model = model_of([*model.groups.values(), *results.groups])
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    with Database.open(path) as database:
        database.declare(_with_the_rest(model, played))
        argued = unreachable_items(campaign, robot, model)
        for (group, item), reason in {**argued, **results.unreachable}.items():
            database.exclude(group, item, reason)
        for number, test_run in enumerate(played):
            test, outcome = test_run.job.test, test_run.outcome
            record = TestRecord(
                test.name,
                campaign=campaign.name,
                strategy=test.strategy,
                seed=test.seed,
                system=robot,
                verdicts=outcome.verdicts,
                ending=outcome.ending,
                error=outcome.error or "",
                number=number,
                seconds=outcome.seconds,
                # The place in the plan, not the time of day: the same campaign writes the same
                # file.
                when=number,
                expected=accepted_failures(test_run, campaign.expected_failures),
            )
            database.record(record, outcome.hits)


def _with_the_rest(model: Model, played: Sequence[Played]) -> Model:
    """A model with what was seen that nobody declared: it is shown, and is no goal."""
    groups: dict[str, Group] = dict(model.groups)
    for test_run in played:
        for name, items in test_run.outcome.hits.items():
            known = groups[name].items
            if not items.keys() <= known.keys():
                rest = {item: Item(item, BinKind.IGNORE) for item in items if item not in known}
                groups[name] = replace(groups[name], items={**known, **rest})
    return Model(groups)


def write_coverage(
    folder: Path, results: Results, pages: Mapping[tuple[str, str], str]
) -> dict[str, CoverageFigures]:
    """Write the database of each robot's tests, and a page beside it; the code for other tools.

    `pages` has the addresses of pages of runs.

    Raises:
        RvmonError: a file cannot be written.
    """
    campaign = results.plan.campaign
    figures = {}
    for robot, path in database_paths(folder, campaign.robots).items():
        played = results.counting(robot)
        write_database(path, robot, played, results)
        up = "../" * len(path.parent.relative_to(folder).parts)
        addresses = {test: f"{up}{page}" for (of, test), page in pages.items() if of == robot}
        title = campaign.robots[robot].title or robot
        summary = Summary(f"{campaign.name}, {title}", read([path]), pages=addresses)
        page = path.with_suffix(".html")
        write_whole(page, coverage_page(summary))
        if campaign.code is not None:
            model = coverage_model(campaign, robot)
            model = without(model, unreachable_items(campaign, robot, model))
            hits = merged(test_run.outcome.hits for test_run in played)
            write_whole(path.with_name(LCOV), lcov(campaign.code, model, hits))
            write_whole(path.with_name(COBERTURA), cobertura(campaign.code, model, hits))
        figures[robot] = CoverageFigures(
            page.relative_to(folder).as_posix(),
            summary.share,
            len(summary.holes),
            tuple(summary.item_name(place) for place in summary.illegal),
        )
    return figures


def database_paths(folder: Path, robots: Mapping[str, Robot]) -> dict[str, Path]:
    """The paths of a campaign's databases, by robot."""
    if len(robots) == 1:
        return dict.fromkeys(robots, folder / DATABASE)
    return {robot: folder / robot / DATABASE for robot in robots}
