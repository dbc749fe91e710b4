"""The legacy robot's Table 1 over many campaign seeds, beside the paper's figures.

    python -m benchmarks.table1_bands --seeds 20

Prints for each cell that is not nought everywhere the mean and the band that holds 95 % of the
campaigns (empirical quantiles), with and without the fitted loss of signals at start-up, and
whether the paper's figure lies inside. A campaign is 100 tests per random strategy, and four of the
model. With `--write` the least and the greatest count of each cell are kept for the page of the
demo.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from statistics import fmean, quantiles

from rich import box
from rich.console import Console
from rich.table import Table

from handover.campaign.campaign import handover_campaign
from handover.campaign.table1 import FITTED, SPREAD_FILE, Spread, paper_table, write_spread
from rvmon.cdv.plan import Played, plan
from rvmon.cdv.play import execute
from rvmon.verdict.verdict import Verdict

STRATEGIES = ("pseudorandom", "constrained", "model-based")

Cell = tuple[str, str, Verdict]
"""Strategy, requirement, verdict."""

Ranges = dict[str, dict[str, dict[str, tuple[int, int]]]]
"""Least and greatest count by strategy, requirement and verdict."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the campaigns and print the bands."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--seeds", type=int, default=20, help="campaigns")
    parser.add_argument("--first", type=int, default=1, help="seed of the first campaign")
    parser.add_argument("--tests", type=int, default=100, help="per strategy and campaign")
    parser.add_argument("--jobs", type=int, help="processes (default: all cores)")
    parser.add_argument("--write", action="store_true", help=f"write {SPREAD_FILE}")
    options = parser.parse_args(argv)
    fitted: list[dict[Cell, int]] = []
    unfitted: list[dict[Cell, int]] = []
    for seed in range(options.first, options.first + options.seeds):
        campaign = handover_campaign(("legacy",))
        chosen = plan(campaign, STRATEGIES, tests=options.tests, seed=seed)
        results = execute(chosen, jobs=options.jobs)
        if results.cut_short:
            print(f"{results.cut_short} in campaign {seed}", file=sys.stderr)
            return 130
        fitted.append(count(results.played))
        without = [replace(one, outcome=one.control or one.outcome) for one in results.played]
        unfitted.append(count(without))
        print(f"campaign {seed}: {results.seconds:.1f} s", file=sys.stderr)
    show(fitted, unfitted, options.tests)
    if options.write:
        spread = ranges(fitted)
        write_spread(Spread(options.first, options.first + options.seeds - 1, spread))
    return 0


def ranges(campaigns: Sequence[Mapping[Cell, int]]) -> Ranges:
    """The least and the greatest count of each cell, by strategy, requirement and verdict."""
    found: Ranges = {}
    for cell in published():
        strategy, requirement, verdict = cell
        counts = values(campaigns, cell)
        row = found.setdefault(strategy, {}).setdefault(requirement, {})
        row[verdict.value] = min(counts), max(counts)
    return found


def count(played: Sequence[Played]) -> dict[Cell, int]:
    """The number of tests in each cell."""
    cells: dict[Cell, int] = {}
    for one in played:
        for requirement, verdict in one.outcome.verdicts.items():
            cell = one.job.test.strategy, requirement, verdict
            cells[cell] = cells.get(cell, 0) + 1
    return cells


def published() -> dict[Cell, int]:
    """The paper's figures, all cells."""
    return {
        (group.name, requirement, verdict): figure
        for group in paper_table().groups
        if group.name in STRATEGIES
        for requirement, counts in group.counts.items()
        for verdict, figure in counts.items()
    }


def show(fitted: list[dict[Cell, int]], unfitted: list[dict[Cell, int]], tests: int) -> None:
    """Print one row per cell that occurs, ours or the paper's, and what lies outside."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in (
        "strategy",
        "cell",
        "paper",
        "mean",
        "95 % band",
        "",
        "no loss",
        "95 % band",
        "",
    ):
        table.add_column(
            heading,
            no_wrap=True,
            justify="right" if heading in ("paper", "mean", "no loss") else "left",
        )
    inside = {"with": 0, "without": 0}
    paper = published()
    for cell, figure in paper.items():
        strategy, requirement, verdict = cell
        columns = {"with": values(fitted, cell), "without": values(unfitted, cell)}
        shown = []
        for name, figures in columns.items():
            low, high = band(figures)
            scale = 1 if strategy == "model-based" else tests / 100
            hit = low <= figure * scale <= high
            inside[name] += hit
            shown += [f"{fmean(figures):.1f}", f"[{low:.1f}, {high:.1f}]", "" if hit else "OUT"]
        if figure or any(any(figures) for figures in columns.values()):
            mark = " fitted" if (strategy, requirement) in FITTED else ""
            table.add_row(strategy, f"{requirement} {verdict.value}{mark}", str(figure), *shown)
    console = Console(highlight=False, width=110)
    console.print(table)
    console.print(f"{len(fitted)} campaigns; cells that are nought in all of them are not shown.")
    for name, hits in inside.items():
        console.print(
            f"{name} the fitted loss: {hits} of {len(paper)} cells hold the paper's figure"
        )


def values(campaigns: Sequence[Mapping[Cell, int]], cell: Cell) -> list[int]:
    """The counts of one cell over all campaigns."""
    return [cells.get(cell, 0) for cells in campaigns]


def band(figures: Sequence[int]) -> tuple[float, float]:
    """The 2.5 and 97.5 percentiles."""
    if len(figures) < 2:
        return float(figures[0]), float(figures[0])
    cuts = quantiles(figures, n=40, method="inclusive")
    return cuts[0], cuts[-1]


if __name__ == "__main__":
    sys.exit(main())
