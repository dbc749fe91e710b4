"""What a campaign has covered, in its folder: a database and a page for each robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from rvmon.cdv.database import declare, record
from rvmon.cdv.outcome import Results
from rvmon.coverage.database import read
from rvmon.report.coverage_page import coverage_page
from rvmon.report.coverage_summary import Summary
from rvmon.session import Spec
from rvmon.writing import write_whole

DATABASE = "coverage.db"
"""The file in a campaign's folder; of several robots, each has one in a folder of its name."""


@dataclass(frozen=True, slots=True)
class CoverageFigures:
    """What one robot's tests have covered.

    Attributes:
        page: its address in the campaign's folder.
        share: of the model, from 0 to 1.
        holes: items that were not hit as often as they have to be.
        illegal: what was hit and must not be.
    """

    page: str
    share: float
    holes: int
    illegal: tuple[str, ...]


def write_coverage(
    folder: Path,
    results: Results,
    specs: Mapping[str, Spec],
    pages: Mapping[tuple[str, str], str],
) -> dict[str, CoverageFigures]:
    """Write the database of each robot's tests, and a page beside it; those there are replaced.

    Args:
        folder: of the campaign.
        results: its outcomes.
        specs: by robot, what judged it.
        pages: addresses of pages of runs in the folder, by robot and test.

    Raises:
        CoverageError: a file cannot be written, or see `rvmon.cdv.database.declare`.
    """
    figures = {}
    robots = results.plan.campaign.robots
    for robot, about in robots.items():
        own = _of(results, robot)
        path = folder / DATABASE if len(robots) == 1 else folder / robot / DATABASE
        path.parent.mkdir(parents=True, exist_ok=True)
        path.unlink(missing_ok=True)
        declare(path, own.plan.campaign, specs)
        record(path, own)
        up = "../" * len(path.parent.relative_to(folder).parts)
        shown = {test: f"{up}{address}" for (of, test), address in pages.items() if of == robot}
        name = f"{own.plan.campaign.name}, {about.title or robot}"
        summary = Summary(name, read([path]), pages=shown)
        page = path.with_suffix(".html")
        write_whole(page, coverage_page(summary))
        figures[robot] = CoverageFigures(
            page.relative_to(folder).as_posix(),
            summary.share,
            len(summary.holes),
            tuple(summary.item_name(place) for place in summary.illegal),
        )
    return figures


def _of(results: Results, robot: str) -> Results:
    """What came out of the tests of one robot."""
    campaign = results.plan.campaign
    alone = replace(campaign, robots={robot: campaign.robots[robot]})
    played = tuple(one for one in results.played if one.job.robot == robot)
    return replace(results, plan=replace(results.plan, campaign=alone), played=played)
