"""Table 1 over many seeds, and conformance of runs to the model.

    python -m benchmarks.table1 bands --seeds 20 [--write]
    python -m benchmarks.table1 conformance --tests 20

`bands` plays the legacy robot's campaign (100 tests per random strategy, four of the model) for
each seed. For each cell that is not 0 in all campaigns it prints the mean, the band that holds 95 %
of the campaigns (empirical quantiles), with and without the fitted loss of signals at start-up, and
whether the paper's figure lies inside. `--write` stores the smallest and the largest count for the
page of the demo. `conformance` compares runs with the network: every run of the correct robot
should conform, and a mutant is rejected if one of its runs does not.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from statistics import fmean, quantiles

from benchmarks.program import program

from handover.campaign.campaign import handover_campaign
from handover.campaign.table1 import FITTED, Spread, paper_table, write_spread
from handover.checker.conformance import check_run
from handover.driver import run_test
from handover.generator.abstract_test import AbstractTest, directed
from handover.generator.model_based import model_based
from handover.generator.pseudorandom import constrained, pseudorandom
from handover.model import handover_network
from handover.robot.mutants import MUTATIONS
from rvmon.cdv.campaign_plan import Played, plan
from rvmon.cdv.play import execute
from rvmon.models.network import Network
from rvmon.verdicts import Verdict

STRATEGIES = ("pseudorandom", "constrained", "model-based")

Cell = tuple[str, str, Verdict]
"""Strategy, requirement, verdict."""


def bands(*, seeds: int = 20, seed: int = 1, write: bool = False) -> int:
    """Print the band of each cell over several campaigns, on all cores."""
    fitted: list[Counter[Cell]] = []
    unfitted: list[Counter[Cell]] = []
    for number in range(seed, seed + seeds):
        campaign = handover_campaign(("legacy",))
        results = execute(plan(campaign, STRATEGIES, tests=100, seed=number))
        if results.cut_short:
            print(f"{results.cut_short} in campaign {number}", file=sys.stderr)
            return 130
        fitted.append(_count(results.played))
        unfitted.append(
            _count([replace(one, outcome=one.control or one.outcome) for one in results.played])
        )
        print(f"campaign {number}: {results.seconds:.1f} s", file=sys.stderr)
    _show(fitted, unfitted)
    if write:
        spread: dict[str, dict[str, dict[str, tuple[int, int]]]] = {}
        for (strategy, requirement, verdict), counts in _by_cell(fitted).items():
            row = spread.setdefault(strategy, {}).setdefault(requirement, {})
            row[verdict.value] = min(counts), max(counts)
        write_spread(Spread(seed, seed + seeds - 1, spread))
    return 0


def _count(played: Sequence[Played]) -> Counter[Cell]:
    """The number of tests in each cell."""
    return Counter(
        (one.job.test.strategy, requirement, verdict)
        for one in played
        for requirement, verdict in one.outcome.verdicts.items()
    )


def _published() -> dict[Cell, int]:
    return {
        (group.name, requirement, verdict): figure
        for group in paper_table().groups
        if group.name in STRATEGIES
        for requirement, counts in group.counts.items()
        for verdict, figure in counts.items()
    }


def _by_cell(campaigns: Sequence[Mapping[Cell, int]]) -> dict[Cell, list[int]]:
    return {cell: [cells.get(cell, 0) for cells in campaigns] for cell in _published()}


def _show(fitted: Sequence[Mapping[Cell, int]], unfitted: Sequence[Mapping[Cell, int]]) -> None:
    """Print a row for each cell that is not always 0; `OUT` marks figures outside the band."""
    columns = {"with": _by_cell(fitted), "without": _by_cell(unfitted)}
    inside = Counter[str]()
    published = _published()
    print(f"{'strategy':14}{'cell':14}{'paper':>6}{'with the loss':>26}{'without':>26}")
    for cell, figure in published.items():
        shown = ""
        for name, figures in columns.items():
            low, high = _band(figures[cell])
            inside[name] += low <= figure <= high
            mark = "" if low <= figure <= high else "OUT"
            shown += f"{fmean(figures[cell]):8.1f} [{low:5.1f}, {high:5.1f}]{mark:>4}"
        if figure or any(any(figures[cell]) for figures in columns.values()):
            strategy, requirement, verdict = cell
            name = f"{requirement} {verdict}{' fitted' if cell[:2] in FITTED else ''}"
            print(f"{strategy:14}{name:14}{figure:6}{shown}")
    print(f"{len(fitted)} campaigns; cells that are nought in all of them are not shown.")
    for name, hits in inside.items():
        print(f"{name} the fitted loss: {hits} of {len(published)} cells hold the paper's figure")


def _band(figures: Sequence[int]) -> tuple[float, float]:
    """The 2.5 and 97.5 percentiles."""
    if len(figures) < 2:
        return float(figures[0]), float(figures[0])
    cuts = quantiles(figures, n=40, method="inclusive")
    return cuts[0], cuts[-1]


def conformance(*, tests: int = 20, seed: int = 1) -> int:
    """Print how many runs of each strategy conform, and which mutants; exit 1 if a run does not."""
    network = handover_network()
    own = [test for test in directed() if test.mutation is None and test.robot != "legacy"]
    groups = {
        "pseudorandom": pseudorandom(tests, seed),
        "constrained": constrained(tests, seed),
        "model-based": model_based(4, seed),
        "directed": own,
    }
    diverging = 0
    for name, group in groups.items():
        bad = [test for test in group if not _conforms(network, test, None)]
        diverging += len(bad)
        print(f"{name:14} {len(group) - len(bad)} of {len(group)} runs conform", flush=True)
        print("".join(f"    not: {test.name}\n" for test in bad), end="")
    hunters = (*model_based(4, seed), *constrained(3, seed), *pseudorandom(3, seed))
    rejected = 0
    for mutation in MUTATIONS:
        killer = next((t.name for t in hunters if not _conforms(network, t, mutation)), None)
        rejected += killer is not None
        told = f"rejected by {killer}" if killer else "accepted"
        print(f"mutant {mutation:20} {told}", flush=True)
    print(f"{rejected} of {len(MUTATIONS)} mutants rejected")
    return int(diverging > 0)


def _conforms(network: Network, test: AbstractTest, mutation: str | None) -> bool:
    run = run_test(test, robot="correct", mutation=mutation, startup_loss=False)
    return bool(check_run(network, run).conforms)


if __name__ == "__main__":
    sys.exit(program(__doc__, bands, conformance))
