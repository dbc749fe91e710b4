"""Coverage as data for other programs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from rvmon.coverage.record import UNKNOWN
from rvmon.report.coverage_summary import Summary


def coverage_data(summary: Summary) -> dict[str, Any]:
    """All that is known, as objects that JSON has."""
    coverage, records = summary.coverage, [entry.record for entry in summary.coverage.entries]
    return {
        "share": summary.share,
        "groups": [_group(summary, name) for name in coverage.model.groups],
        "holes": _items(summary, summary.holes),
        "illegal": _items(summary, summary.illegal),
        "tests": [
            {
                "name": record.name,
                "campaign": record.campaign,
                "strategy": record.strategy,
                "recording": record.recording,
                "seed": record.seed,
                "system": record.system,
                "verdicts": record.verdicts,
                "expected": record.expected,
                "ending": record.ending,
                "error": record.error,
                "seconds": record.seconds,
                "when": record.when,
                "added": _items(summary, step.added),
                "share": step.share,
                "only_by_it": _items(summary, only),
            }
            for record, step, only in zip(records, summary.steps, summary.unique, strict=True)
        ],
        "shortest_known_order": [
            {
                "test": step.entry,
                "name": records[step.entry].name,
                "added": _items(summary, step.added),
                "share": step.share,
            }
            for step in summary.ranking
        ],
        "compared": _compared(summary),
    }


def _group(summary: Summary, name: str) -> dict[str, Any]:
    group, score = summary.coverage.model.groups[name], summary.scores[name]
    return {
        "name": name,
        "title": group.title,
        "subject": group.subject,
        "weight": group.weight,
        "items": score.items,
        "covered": score.covered,
        "axes": group.axes,
        "bins": [
            {
                "name": item.name,
                "text": item.text,
                "kind": item.kind,
                "goal": item.goal,
                "hits": int(summary.totals.counts[place]),
                "tests": int(summary.totals.tests[place]),
                "first": _first(summary, place),
                "reasons": summary.coverage.reasons.get((name, item.name), ()),
                "hole": summary.hole_texts.get(place),
                "unreachable": summary.coverage.unreachable.get((name, item.name), ()),
            }
            for place, item in summary.places(group)
        ],
    }


def _first(summary: Summary, place: int) -> dict[str, Any] | None:
    """The test that hit an item first, by its place among the tests, and the instant in ns."""
    entry = int(summary.totals.first[place])
    if entry < 0:
        return None
    instant = int(summary.totals.instants[place])
    return {
        "test": entry,
        "name": summary.record(entry).name,
        "at": None if instant == UNKNOWN else instant,
    }


def _items(summary: Summary, places: Iterable[int]) -> list[tuple[str, str]]:
    return [summary.coverage.items[place] for place in places]


def _compared(summary: Summary) -> dict[str, Any] | None:
    found = summary.comparison
    return None if found is None else {"with": summary.earlier_name, **asdict(found)}
