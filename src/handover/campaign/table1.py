"""The paper's Table 1 next to ours, the model's verdicts, and the spread of counts over seeds.

Source: D. Araiza-Illan, D. Western, A. Pipe, K. Eder, "Coverage-Driven Verification: An approach
to verify code for robots that directly interact with humans", Haifa Verification Conference 2015,
section 5, Table 1 (there the requirements are numbered 1 to 5).
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path

import msgspec
from msgspec.structs import replace

from rvmon.cdv import tables
from rvmon.cdv.campaign_summary import CampaignSummary
from rvmon.cdv.tables import RobotTables
from rvmon.files import write_whole
from rvmon.report.verdict_table import RunGroup, VerdictTable
from rvmon.verdicts import Verdict

SOURCE = "Araiza-Illan et al., Coverage-Driven Verification, HVC 2015, Table 1"

_CHECKED = {"R1": True, "R2": True, "R3": True, "R4": True, "R5": None}

_PUBLISHED = {
    "pseudorandom": ((0, 0, 100, 0), (33, 0, 67, 0), (33, 0, 67, 0), (98, 0, 0, 2), (46, 0, 54, 0)),
    "constrained": ((0, 0, 100, 0), (87, 0, 13, 0), (87, 0, 13, 0), (98, 0, 0, 2), (93, 0, 7, 0)),
    "model-based": ((3, 0, 1, 0), (1, 0, 3, 0), (4, 0, 0, 0), (4, 0, 0, 0), (4, 0, 0, 0)),
}
"""The numbers of tests with P, F, NT and I, for R1 to R5."""

FITTED_BY_LOSS = {("constrained", "R5")}
"""Cells of the table that the fitted start-up loss reproduces by construction."""

FITTED_BY_SLOWNESS = {("pseudorandom", "R4"), ("constrained", "R4")}
"""Cells to which the slowness of polls was fitted."""

FITTED = FITTED_BY_LOSS | FITTED_BY_SLOWNESS
"""Cells that are not evidence, as they were fitted."""


def paper_table() -> VerdictTable:
    """The paper's table."""
    groups = []
    for name, rows in _PUBLISHED.items():
        counts = (dict(zip(Verdict, row, strict=True)) for row in rows)
        groups.append(RunGroup(name, sum(rows[0]), dict(zip(_CHECKED, counts, strict=True))))
    return VerdictTable(
        title="As published",
        requirements=dict.fromkeys(_CHECKED, ""),
        groups=tuple(groups),
        checked=_CHECKED,
        notes=(f"Source: {SOURCE}",),
    )


SPREAD_FILE = "spread.json"
"""Next to this module; `python -m benchmarks.table1 bands --seeds 10 --write` writes it."""


class Spread(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The ranges of counts over campaigns with 100 tests of each random strategy."""

    first: int  # seed of the first campaign
    last: int  # seed of the last campaign
    # The smallest and the largest count, by strategy, requirement and verdict.
    ranges: Mapping[str, Mapping[str, Mapping[str, tuple[int, int]]]]


def spread() -> Spread:
    """The computed ranges.

    >>> spread().ranges["model-based"]["R1"]["P"]
    (2, 3)
    """
    return msgspec.json.decode(_path().read_bytes(), type=Spread)


def write_spread(found: Spread) -> None:
    """Write the computed ranges."""
    write_whole(_path(), msgspec.json.encode(found) + b"\n")


def spread_text() -> str:
    """The counts of passed tests that vary with the seed, in a sentence."""
    found = spread()
    parts = []
    for strategy, rows in found.ranges.items():
        cells = [(name, *row["P"]) for name, row in rows.items()]
        varying = [f"{name} {low}–{high}" for name, low, high in cells if low != high]
        if varying:
            parts.append(f"{strategy} {', '.join(varying)}")
    return (
        f"Over the seeds {found.first} to {found.last}, with 100 tests of each random strategy, P "
        f"varies: {'; '.join(parts)} (python -m benchmarks.table1 bands)."
    )


def _path() -> Path:
    return Path(__file__).with_name(SPREAD_FILE)


@cache
def check_model(requirements: tuple[str, ...]) -> dict[str, bool | None]:
    """Ask the model checker for a run that shows each requirement, as the paper did.

    The result is `None` for a requirement that the model cannot express and so has no query for.
    """
    from handover.model import handover_network
    from rvmon.models.search.verify import verify

    network = handover_network()
    queries = {query.id: query for query in network.queries}
    return {
        name: verify(network, queries[name]).holds if name in queries else None
        for name in requirements
    }


WITNESSES = (
    "Model-based tests follow a run of the model for each query: the likeliest by the "
    "model's weights (model-based), the one with the fewest steps (model-based-shortest), "
    "the one that takes the least time (model-based-fastest)."
)


def robot_tables(summary: CampaignSummary) -> dict[str, RobotTables]:
    """The tables of each robot; the published table is about the legacy one."""
    shown = {}
    checked = checked_of(summary)
    for name, table in tables.robot_tables(summary).items():
        notes = table.own.notes
        if "model-based" in summary.robots[name].strategies:
            notes = (*notes, WITNESSES)
        own = replace(table.own, checked=checked, notes=notes)
        control = table.control if name == "legacy" else None
        if control is not None:
            title = f"{summary.robots[name].title}, without the fitted loss of signals at start-up"
            control = replace(control, title=title)
        shown[name] = RobotTables(
            own=own,
            compared={"paper": paper_table()} if name == "legacy" else {},
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
    """The results of model checking by requirement, if tests were taken from the model."""
    robots = summary.robots.values()
    if not any("model-based" in robot.strategies for robot in robots):
        return {}
    return check_model(tuple(dict.fromkeys(id_ for robot in robots for id_ in robot.requirements)))


def _fitted(table: VerdictTable, unfitted: VerdictTable) -> str:
    """The fitted cells with their counts with and without the fit, in words."""
    shown = []
    for strategy, requirement in sorted(FITTED_BY_LOSS):
        with_fit, without = (
            "/".join(map(str, (one.counts(strategy, requirement) or {}).values()))
            for one in (table, unfitted)
        )
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


def table_document(summary: CampaignSummary) -> dict[str, object]:
    """The content of `table.json`; the seed determines everything but `seconds`."""
    checked = checked_of(summary)
    more: dict[str, object] = {"model_checking": checked} if checked else {}
    table = paper_table()
    more["paper"] = {
        "source": SOURCE,
        "model_checking": table.checked,
        "strategies": {
            group.name: {"tests": group.runs, "requirements": tables.rows_document(group.counts)}
            for group in table.groups
        },
    }
    return tables.table_document(summary, control_key="without_startup_loss", more=more)
