"""Reports as JSON and back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any

import msgspec

from rvmon.errors import TraceError
from rvmon.trace.health import Health
from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.verdict.assemble import report_of
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict

_ALWAYS = ("number", "triggered", "decided", "verdict", "decision", "reason")
"""Keys that every attempt has in JSON; the others are left out where they are empty."""


class _AttemptsJson(msgspec.Struct):
    attempts: list[dict[str, Any]]
    nearest_miss: str = ""


class _ReportJson(msgspec.Struct):
    requirements: dict[str, _AttemptsJson]
    health: list[Health]
    trace: str = ""
    origin: int = 0
    end: int | None = None
    goals: dict[str, Verdict] = {}


def encode(report: Report) -> str:
    """Write a report as JSON text."""
    attempts: dict[str, list[dict[str, object]]] = {name: [] for name in report.verdicts}
    for attempt in report.attempts:
        seconds = {
            "triggered_s": _seconds(attempt.triggered, report.origin),
            "decided_s": _seconds(attempt.decided, report.origin),
        }
        attempts[attempt.requirement].append({**_attempt(attempt), **seconds})
    document = {
        "trace": report.trace,
        "origin": report.origin,
        "end": report.end,
        "requirements": {
            name: {
                "verdict": verdict,
                "attempts": attempts[name],
                "counts": report.counts[name],
                **({"nearest_miss": report.misses[name]} if name in report.misses else {}),
            }
            for name, verdict in report.verdicts.items()
        },
        "health": report.health,
        **({"goals": report.goals} if report.goals else {}),
    }
    return msgspec.json.encode(document).decode()


def encode_broken(trace: str, error: str, before: Sequence[Attempt]) -> str:
    """Write as JSON text what is known of a recording that broke off.

    It has no verdicts: what comes behind the break could still have changed them.

    Args:
        trace: its path.
        error: what was wrong with it.
        before: the attempts that were decided before the break.
    """
    attempts: dict[str, list[dict[str, object]]] = {}
    for attempt in before:
        attempts.setdefault(attempt.requirement, []).append(_attempt(attempt))
    document = {"trace": trace, "error": error, "judged_before": attempts}
    return msgspec.json.encode(document).decode()


def decode(text: str | bytes) -> Report:
    """Read a report from JSON text.

    Verdicts and counts are folded anew from the attempts.

    Raises:
        TraceError: the text is no report.
    """
    try:
        document = msgspec.json.decode(text, type=_ReportJson)
        attempts = [
            msgspec.convert({**fields, "requirement": name}, Attempt)
            for name, entry in document.requirements.items()
            for fields in entry.attempts
        ]
    except (msgspec.DecodeError, msgspec.ValidationError, UnicodeDecodeError) as error:
        raise TraceError(f"this is no report of rvmon: {error}") from None
    report = report_of(
        tuple(document.requirements),
        attempts,
        health=document.health,
        trace=document.trace,
        origin=document.origin,
        end=document.end,
    )
    found = {name: entry.nearest_miss for name, entry in document.requirements.items()}
    misses = {name: miss for name, miss in found.items() if miss}
    return replace(report, misses=misses, goals=document.goals)


def _attempt(attempt: Attempt) -> dict[str, object]:
    shown: dict[str, object] = {}
    for field in fields(Attempt):
        value = getattr(attempt, field.name)
        if field.name in _ALWAYS or value not in (None, "", {}):
            shown[field.name] = value
    del shown["requirement"]
    return shown


def _seconds(instant: int | None, origin: int) -> float | None:
    return None if instant is None else (instant - origin) / TICKS_PER_SECOND
