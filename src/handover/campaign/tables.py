"""The tables of the two robots beside the paper's."""

from __future__ import annotations

from dataclasses import replace

from handover.campaign.model_checking import check_model
from handover.campaign.paper import FITTED_BY_LOSS, SOURCE, paper_table
from handover.campaign.spread import spread_text
from rvmon.cdv import tables
from rvmon.cdv.summary import CampaignSummary
from rvmon.cdv.tables import RobotTables
from rvmon.report.table import VerdictTable
from rvmon.verdict.verdict import Verdict

WITNESSES = (
    "Model-based tests follow a run of the model for each query: the likeliest by the "
    "model's weights (model-based), the one with the fewest steps (model-based-shortest), "
    "the one that takes the least time (model-based-fastest)."
)


def robot_tables(summary: CampaignSummary) -> dict[str, RobotTables]:
    """The tables of each robot; the legacy one is that which the published table speaks of."""
    shown = {}
    checked = checked_of(summary)
    for name, one in tables.robot_tables(summary).items():
        notes = one.own.notes
        if "model-based" in summary.robots[name].strategies:
            notes = (*notes, WITNESSES)
        own = replace(one.own, checked=checked, notes=notes)
        control = one.control if name == "legacy" else None
        if control is not None:
            title = f"{summary.robots[name].title}, without the fitted loss of signals at start-up"
            control = replace(control, title=title)
        shown[name] = RobotTables(
            own=own,
            beside={"paper": paper_table()} if name == "legacy" else {},
            control=control,
            control_label="no fit",
            control_title="The same without the fitted loss of signals",
            sources=(f"paper: {SOURCE}", spread_text()) if name == "legacy" else (),
            remark=_fitted(own, control) if control is not None else "",
            witnesses={name: witness_test(name) for name, holds in checked.items() if holds},
        )
    return shown


def witness_test(requirement: str) -> str:
    """The name of the test that follows the likeliest witness of a requirement."""
    return f"model-based-{requirement}"


def checked_of(summary: CampaignSummary) -> dict[str, bool | None]:
    """What model checking says by requirement, where tests were taken from the model."""
    robots = summary.robots.values()
    if not any("model-based" in robot.strategies for robot in robots):
        return {}
    return check_model(tuple(dict.fromkeys(id_ for robot in robots for id_ in robot.requirements)))


def _fitted(table: VerdictTable, unfitted: VerdictTable) -> str:
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
