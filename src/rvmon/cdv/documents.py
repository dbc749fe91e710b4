"""A campaign's figures as documents: `table.json`, `coverage.json`."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from rvmon.cdv.run_share import ALPHA, BETA, Decision
from rvmon.cdv.summary import CampaignSummary, RobotSummary, StrategySummary
from rvmon.confidence import interval
from rvmon.report.table import Counts


def table_document(
    summary: CampaignSummary,
    *,
    control_key: str = "control",
    more: Mapping[str, object] | None = None,
) -> dict[str, object]:
    """The content of `table.json`; all of it but `seconds` follows from the seed.

    Args:
        summary: the figures.
        control_key: the key of the counts with controls in the place of their tests.
        more: further entries.
    """
    robots = {name: _robot(one, summary.kind, control_key) for name, one in summary.robots.items()}
    document: dict[str, object] = {"seed": summary.seed, "robots": robots, **(more or {})}
    if summary.cut_short:
        document["partial"] = {
            "why": summary.cut_short,
            "planned": summary.planned,
            "finished": summary.finished,
        }
    document["seconds"] = round(summary.seconds, 2)
    return document


def _robot(robot: RobotSummary, kind: str, control_key: str) -> dict[str, object]:
    document: dict[str, object] = {
        "spec": robot.spec,
        "strategies": {name: _strategy(one, kind) for name, one in robot.strategies.items()},
    }
    if robot.controls:
        document[control_key] = {
            "strategies": {
                name: {"tests": robot.strategies[name].tests, "requirements": rows_document(rows)}
                for name, rows in robot.controls.items()
            }
        }
    if robot.known:
        document["known_answers"] = {
            one.test: {
                "mutation": one.mutation,
                "expected": one.expected,
                "verdicts": one.verdicts,
                "missed": one.missed,
                "as_expected": one.as_expected,
            }
            for one in robot.known
        }
    return document


def rows_document(rows: Mapping[str, Counts]) -> dict[str, dict[str, int]]:
    """Counts of tests by requirement and verdict."""
    return {
        name: {verdict.value: count for verdict, count in counts.items()}
        for name, counts in rows.items()
    }


def _intervals(counts: Counts) -> dict[str, list[float]]:
    """The bounds of the share of tests behind each count; there is at least one test."""
    runs = sum(counts.values())
    return {
        verdict.value: [round(bound, 4) for bound in interval(count, runs)]
        for verdict, count in counts.items()
    }


def coverage_document(summary: CampaignSummary) -> dict[str, object]:
    """The content of `coverage.json`: statements, branches, states and transitions."""
    return {
        "robots": {
            name: {
                "strategies": {
                    strategy: _coverage(figures, summary.kind)
                    for strategy, figures in robot.strategies.items()
                }
            }
            for name, robot in summary.robots.items()
        }
    }


def to_json(document: Mapping[str, object]) -> bytes:
    """A document as indented JSON, keys in their order."""
    return msgspec.json.format(msgspec.json.encode(document), indent=2) + b"\n"


def _strategy(figures: StrategySummary, kind: str) -> dict[str, object]:
    document: dict[str, object] = {
        "tests": figures.tests,
        "requirements": rows_document(figures.counts),
        "intervals": {name: _intervals(one) for name, one in figures.counts.items()},
    }
    if figures.statements:
        document["statements"] = {
            "percent": figures.total.percent,
            f"by_{kind}": {name: one.percent for name, one in figures.statements.items()},
        }
    if figures.shares:
        document["shares"] = {name: _share(one) for name, one in figures.shares.items()}
    document["simulated_s"] = round(figures.simulated_s, 3)
    for name, figure in figures.figures.items():
        document.setdefault(name, round(figure, 3))
    for ending in ("crashes", "hung", "lost"):
        if errors := getattr(figures, ending):
            document[ending] = errors
    return document


def _share(decision: Decision) -> dict[str, object]:
    return {
        "required": str(decision.share),
        "holds": decision.holds,
        "tests": decision.tests,
        "passed": decision.passed,
        "inconclusive": decision.inconclusive,
        "missing": decision.missing,
        "alpha": ALPHA,
        "beta": BETA,
        "indifference": [round(bound, 6) for bound in decision.indifference],
    }


def _coverage(figures: StrategySummary, kind: str) -> dict[str, object]:
    document: dict[str, object] = {"tests": figures.tests}
    if figures.statements:
        document["percent"] = figures.total.percent
        document[f"by_{kind}"] = {
            name: {
                "statements": one.statements,
                "covered": one.covered,
                "percent": one.percent,
                "missing_lines": [int(line) for line in one.missing],
            }
            for name, one in figures.statements.items()
        }
    if figures.branches:
        document["branches"] = {
            name: {"branches": one.statements, "covered": one.covered, "missing": one.missing}
            for name, one in figures.branches.items()
        }
    document["transitions"] = [
        {"from": source, "to": target, "tests": tests}
        for (source, target), tests in sorted(figures.transitions.items())
        if tests
    ]
    return document
