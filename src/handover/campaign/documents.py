"""A campaign's figures as documents: `table.json`, `coverage.json`."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from handover.campaign.paper import SOURCE, paper_table
from handover.campaign.summary import CampaignSummary, RobotSummary, StrategySummary
from rvmon.report.table import Counts


def table_document(summary: CampaignSummary) -> dict[str, object]:
    """The content of `table.json`; all of it but `seconds` follows from the seed."""
    document: dict[str, object] = {
        "seed": summary.seed,
        "robots": {name: _robot(robot) for name, robot in summary.robots.items()},
    }
    if summary.checked:
        document["model_checking"] = summary.checked
    document["paper"] = _paper()
    if summary.cut_short:
        document["partial"] = {
            "why": summary.cut_short,
            "planned": summary.planned,
            "finished": summary.finished,
        }
    document["seconds"] = round(summary.seconds, 2)
    return document


def coverage_document(summary: CampaignSummary) -> dict[str, object]:
    """The content of `coverage.json`: statements and transitions of the robot's code."""
    return {
        "robots": {
            name: {
                "strategies": {
                    strategy: _coverage(figures) for strategy, figures in robot.strategies.items()
                }
            }
            for name, robot in summary.robots.items()
        }
    }


def to_json(document: Mapping[str, object]) -> bytes:
    """A document as indented JSON, keys in their order."""
    return msgspec.json.format(msgspec.json.encode(document), indent=2) + b"\n"


def _robot(robot: RobotSummary) -> dict[str, object]:
    document: dict[str, object] = {
        "spec": robot.spec,
        "strategies": {name: _strategy(figures) for name, figures in robot.strategies.items()},
    }
    if robot.unfitted:
        document["without_startup_loss"] = {
            "strategies": {
                name: {"tests": robot.strategies[name].tests, "requirements": _rows(rows)}
                for name, rows in robot.unfitted.items()
            }
        }
    if robot.known:
        document["known_answers"] = {
            one.test: {
                "mutation": one.mutation,
                "expected": one.expected,
                "verdicts": one.verdicts,
                "as_expected": one.as_expected,
            }
            for one in robot.known
        }
    return document


def _strategy(figures: StrategySummary) -> dict[str, object]:
    document: dict[str, object] = {
        "tests": figures.tests,
        "requirements": _rows(figures.counts),
        "statements": {
            "percent": figures.total.percent,
            "by_state": {state: one.percent for state, one in figures.statements.items()},
        },
        "simulated_s": round(figures.simulated_s, 3),
        "stepped_s": round(figures.stepped_s, 3),
    }
    if figures.crashes:
        document["crashes"] = figures.crashes
    return document


def _rows(rows: Mapping[str, Counts]) -> dict[str, dict[str, int]]:
    return {
        name: {verdict.value: count for verdict, count in counts.items()}
        for name, counts in rows.items()
    }


def _coverage(figures: StrategySummary) -> dict[str, object]:
    return {
        "tests": figures.tests,
        "percent": figures.total.percent,
        "by_state": {
            state: {
                "statements": one.statements,
                "covered": one.covered,
                "percent": one.percent,
                "missing_lines": one.missing,
            }
            for state, one in figures.statements.items()
        },
        "transitions": [
            {"from": source, "to": target, "tests": tests}
            for (source, target), tests in sorted(figures.transitions.items())
        ],
    }


def _paper() -> dict[str, object]:
    table = paper_table()
    return {
        "source": SOURCE,
        "model_checking": table.checked,
        "strategies": {
            group.name: {"tests": group.runs, "requirements": _rows(group.counts)}
            for group in table.groups
        },
    }
