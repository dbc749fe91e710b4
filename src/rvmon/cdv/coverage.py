"""The coverage model of a campaign, and the databases and pages of its tests' coverage."""

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

    page: str  # address of the coverage page, relative to the campaign's folder
    share: float  # of the model that is covered, from 0 to 1
    holes: int  # number of items with fewer hits than their goal
    illegal: tuple[str, ...]  # illegal items that were hit


DATABASE = "coverage.db"
"""The file in a campaign's folder; with several robots, in a subfolder named after each robot."""

LCOV, COBERTURA = "code.lcov", "cobertura.xml"
"""Files next to it with the coverage of the code alone, for other tools."""


def coverage_model(campaign: Campaign, robot: str) -> Model:
    """The coverage model of a robot: states, transitions and code, and that of its specifications.

    Raises:
        RvmonError: two groups have the same name.
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
    """The share of a robot's reachable coverage model that some tests covered, from 0 to 1.

    Raises:
        RvmonError: see `coverage_model`.
    """
    model = coverage_model(campaign, robot)
    out = unreachable_items(campaign, robot, model)
    return share(merged(test_run.outcome.hits for test_run in played), without(model, out))


def write_database(path: Path, robot: str, played: Sequence[Played], results: Results) -> None:
    """Write the coverage database of some tests of a robot, replacing an existing file.

    Raises:
        RvmonError: the file cannot be written, or see `coverage_model`.
    """
    campaign = results.plan.campaign
    model = coverage_model(campaign, robot)
    model = model_of([*model.groups.values(), *results.groups])
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    with Database.open(path) as database:
        database.declare(_with_undeclared(model, played))
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


def _with_undeclared(model: Model, played: Sequence[Played]) -> Model:
    """A model with the undeclared items that were hit; these are shown, but are not goals."""
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
    """Write each robot's coverage database and page, and its code coverage for other tools.

    Tests with a planted fault are left out. `pages` has the addresses of the pages of runs,
    relative to `folder`, by robot and test.

    Raises:
        RvmonError: a file cannot be written, or see `coverage_model`.
    """
    campaign = results.plan.campaign
    figures = {}
    for robot, path in database_paths(folder, campaign.robots).items():
        played = results.unmutated(robot)
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
