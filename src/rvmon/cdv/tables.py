"""A campaign's figures as tables of verdicts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from rvmon.cdv.run_share import errors_text
from rvmon.cdv.summary import CampaignSummary, RobotSummary
from rvmon.report.proportion import CONFIDENCE
from rvmon.report.table import Counts, RunGroup, VerdictTable

LEGEND = "Number of tests: P passed, F failed, NT not triggered, I inconclusive."

INTERVALS = (
    f"Below each: the {100 * CONFIDENCE:g} % interval of its share in % (Clopper and Pearson), for "
    "tests that are drawn at random; for tests that are chosen it has no meaning."
)


@dataclass(frozen=True, slots=True)
class RobotTables:
    """What is shown of the verdicts on one robot.

    Attributes:
        own: its counts.
        beside: by label, counts that each row is held against.
        control: the same counts with the controls of tests, where there are some.
        control_label: heads those lines of the text; empty: they stand in files only.
        control_title: heads that table of the page.
        sources: remarks of the page on what stands beside.
        remark: below the tables.
        witnesses: by requirement, the test that follows the run by which model checking shows it.
    """

    own: VerdictTable
    beside: Mapping[str, VerdictTable] = field(default_factory=dict)
    control: VerdictTable | None = None
    control_label: str = ""
    control_title: str = ""
    sources: tuple[str, ...] = ()
    remark: str = ""
    witnesses: Mapping[str, str] = field(default_factory=dict)


def robot_tables(summary: CampaignSummary) -> dict[str, RobotTables]:
    """The tables of each robot that was judged, by its name."""
    return {
        name: RobotTables(
            own=verdict_table(summary, name),
            control=control_table(summary, name),
            control_label=summary.control,
            control_title=f"The same {summary.control}",
        )
        for name in summary.robots
    }


def verdict_table(summary: CampaignSummary, robot: str) -> VerdictTable:
    """The counts of one robot under each strategy."""
    figures = summary.robots[robot]
    counts = {name: strategy.counts for name, strategy in figures.strategies.items()}
    return VerdictTable(
        title=f"{figures.title}, checked against {figures.spec}",
        requirements=figures.requirements,
        groups=_groups(figures, counts),
        notes=_notes(summary, figures),
        shows_intervals=True,
    )


def control_table(summary: CampaignSummary, robot: str) -> VerdictTable | None:
    """The same counts with the controls in the place of their tests; `None` if there are none."""
    figures = summary.robots[robot]
    if not figures.controls:
        return None
    return VerdictTable(
        title=f"{figures.title}, {summary.control}",
        requirements=figures.requirements,
        groups=_groups(figures, figures.controls),
        shows_intervals=True,
    )


def named_tables(tables: Mapping[str, RobotTables], control: str) -> dict[str, VerdictTable]:
    """The tables of all robots by a short name, for files of them.

    Args:
        tables: by robot.
        control: the name of what was played beside tests.
    """
    named: dict[str, VerdictTable] = {}
    for robot, one in tables.items():
        named[robot] = one.own
        if one.control is not None:
            named[f"{robot} {control}"] = one.control
    return named


def _groups(
    figures: RobotSummary, counts: Mapping[str, Mapping[str, Counts]]
) -> tuple[RunGroup, ...]:
    return tuple(
        RunGroup(name, figures.strategies[name].tests, rows) for name, rows in counts.items()
    )


def _notes(summary: CampaignSummary, figures: RobotSummary) -> tuple[str, ...]:
    notes = []
    if summary.cut_short:
        notes.append(
            f"PARTIAL: {summary.cut_short} after {summary.finished} of {summary.planned} tests."
        )
    for strategy, one in figures.strategies.items():
        for name, decision in one.shares.items():
            result = (
                f"{decision}, {errors_text(decision)}" if decision.holds is not None else decision
            )
            notes.append(f"{name} {decision.share}: under {strategy} {result}.")
    strategies = figures.strategies.values()
    if crashed := sum(len(one.crashes) for one in strategies):
        notes.append(
            f"The robot's code crashed in {crashed} tests, which were evaluated all the same."
        )
    for test, why in (item for one in strategies for item in one.hung.items()):
        notes.append(f"{test} hung: {why}, and was ended; nothing is known of it.")
    for test, why in (item for one in strategies for item in one.lost.items()):
        notes.append(f"{test} was lost: {why}; nothing is known of it.")
    return tuple(notes)
