"""A campaign's figures as tables of verdicts, ours and the paper's."""

from __future__ import annotations

from collections.abc import Mapping

from handover.campaign.paper import FITTED_BY_LOSS, paper_table
from handover.campaign.summary import CampaignSummary, RobotSummary
from rvmon.report.table import Counts, RunGroup, VerdictTable
from rvmon.verdict.verdict import Verdict

ROBOTS = {
    "legacy": "Robot of the paper's testbench",
    "correct": "Correct robot",
}
"""What the two robots are called in titles."""


def verdict_table(summary: CampaignSummary, robot: str) -> VerdictTable:
    """The counts of one robot under each strategy."""
    figures = summary.robots[robot]
    tests = {name: strategy.tests for name, strategy in figures.strategies.items()}
    counts = {name: strategy.counts for name, strategy in figures.strategies.items()}
    return VerdictTable(
        title=f"{ROBOTS[robot]}, judged by {figures.spec}",
        requirements=figures.requirements,
        groups=_groups(tests, counts),
        checked=summary.checked,
        notes=_notes(summary, figures),
    )


def unfitted_table(summary: CampaignSummary, robot: str) -> VerdictTable | None:
    """The same counts with no signal lost at start-up; `None` if none was lost."""
    figures = summary.robots[robot]
    if not figures.unfitted:
        return None
    tests = {name: figures.strategies[name].tests for name in figures.unfitted}
    return VerdictTable(
        title=f"{ROBOTS[robot]}, without the fitted loss of signals at start-up",
        requirements=figures.requirements,
        groups=_groups(tests, figures.unfitted),
    )


def all_tables(summary: CampaignSummary) -> dict[str, VerdictTable]:
    """Every table of a campaign and the paper's, by a short name."""
    tables: dict[str, VerdictTable] = {}
    for robot in summary.robots:
        tables[robot] = verdict_table(summary, robot)
        unfitted = unfitted_table(summary, robot)
        if unfitted is not None:
            tables[f"{robot} without start-up loss"] = unfitted
    tables["paper"] = paper_table()
    return tables


def comparable(robot: str) -> VerdictTable | None:
    """The published table, for the robot that it speaks of."""
    return paper_table() if robot == "legacy" else None


def _groups(
    tests: Mapping[str, int], counts: Mapping[str, Mapping[str, Counts]]
) -> tuple[RunGroup, ...]:
    return tuple(RunGroup(name, tests[name], counts[name]) for name in tests)


def _notes(summary: CampaignSummary, figures: RobotSummary) -> tuple[str, ...]:
    notes = []
    if summary.cut_short:
        notes.append(
            f"PARTIAL: {summary.cut_short} after {summary.finished} of {summary.planned} tests."
        )
    if "model-based" in figures.strategies:
        notes.append(
            "Model-based tests follow a run of the model for each query: the likeliest by the "
            "model's weights (model-based), the one with the fewest steps (model-based-shortest), "
            "the one that takes the least time (model-based-fastest)."
        )
    crashed = sum(len(strategy.crashes) for strategy in figures.strategies.values())
    if crashed:
        notes.append(f"The robot's code crashed in {crashed} tests, judged all the same.")
    return tuple(notes)


def fitted_note(table: VerdictTable, unfitted: VerdictTable) -> str:
    """Which cells were fitted, and what they are without the fit."""
    shown = []
    for strategy, requirement in sorted(FITTED_BY_LOSS):
        with_fit, without = (_cell(one, strategy, requirement) for one in (table, unfitted))
        if with_fit and without:
            letters = "/".join(Verdict)
            counts = f"{letters} {with_fit} with it, {without} without"
            shown.append(f"{strategy} {requirement}, by the loss of signals at start-up ({counts})")
    if not shown:
        return ""
    return (
        f"Fitted to the paper's counts, and so no evidence: {'; '.join(shown)}; "
        "R4, by the slowness of polls."
    )


def _cell(table: VerdictTable, strategy: str, requirement: str) -> str:
    for group in table.groups:
        counts = group.counts.get(requirement)
        if group.name == strategy and counts is not None:
            return "/".join(str(counts[verdict]) for verdict in Verdict)
    return ""
