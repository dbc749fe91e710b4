"""Reports as JSON and back."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, Literal

import msgspec

from rvmon.errors import TraceError
from rvmon.trace.health import Health
from rvmon.verdict.assemble import report_of
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.attempt_json import attempt_text, encoded, record
from rvmon.verdict.lazy import LazyAttempts
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import LAW, Verdict


class _AttemptsJson(msgspec.Struct):
    attempts: list[dict[str, Any]]
    verdict: Verdict
    nearest_miss: str = ""
    late: dict[int, int] = {}
    dropped: dict[Literal["P", "F", "I"], Annotated[int, msgspec.Meta(gt=0)]] = {}


class _ReportJson(msgspec.Struct):
    requirements: dict[str, _AttemptsJson]
    health: list[Health]
    law: int = 1  # the first law's reports did not say
    trace: str = ""
    origin: int = 0
    end: int | None = None
    goals: dict[str, Verdict] = {}


def encode(report: Report) -> str:
    """Write a report as JSON text."""
    attempts: dict[str, list[str]] = {name: [] for name in report.verdicts}
    for name, text in _texts(report):
        attempts[name].append(text)
    # Not encoded as one document: the attempts may be many megabytes, which are copied once.
    return "".join(_document(report, attempts))


def _document(report: Report, attempts: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """The parts of a report's text, in order."""
    head = {
        "law": report.law,
        "trace": report.trace,
        "origin": report.origin,
        "end": report.end,
    }
    yield f'{encoded(head)[:-1]},"requirements":{{'
    for number, (name, verdict) in enumerate(report.verdicts.items()):
        comma = "," if number else ""
        yield f'{comma}{encoded(name)}:{{"verdict":{encoded(verdict)},"attempts":['
        for place, text in enumerate(attempts[name]):
            if place:
                yield ","
            yield text
        rest: dict[str, object] = {"counts": report.counts[name]}
        if report.dropped.get(name):
            rest["dropped"] = report.dropped[name]
        if name in report.misses:
            rest["nearest_miss"] = report.misses[name]
        if report.late.get(name):
            rest["late"] = report.late[name]
        yield f"],{encoded(rest)[1:]}"
    tail: dict[str, object] = {"health": report.health}
    if report.goals:
        tail["goals"] = report.goals
    yield f"}},{encoded(tail)[1:]}"


def _texts(report: Report) -> Iterable[tuple[str, str]]:
    """The requirement and the text of each attempt."""
    if isinstance(report.attempts, LazyAttempts):
        return report.attempts.texts(report.origin)
    return ((one.requirement, attempt_text(one, report.origin)) for one in report.attempts)


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
        attempts.setdefault(attempt.requirement, []).append(record(attempt))
    return encoded({"law": LAW, "trace": trace, "error": error, "judged_before": attempts})


def decode(text: str | bytes) -> Report:
    """Read a report from JSON text.

    Verdicts and counts are folded anew from the attempts, and from how many were dropped.

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
        dropped={
            name: {Verdict(verdict): count for verdict, count in entry.dropped.items()}
            for name, entry in document.requirements.items()
            if entry.dropped
        },
        health=document.health,
        untold=[
            name
            for name, entry in document.requirements.items()
            if entry.verdict is Verdict.INCONCLUSIVE
        ],
        trace=document.trace,
        origin=document.origin,
        end=document.end,
    )
    found = {name: entry.nearest_miss for name, entry in document.requirements.items()}
    misses = {name: miss for name, miss in found.items() if miss}
    late = {name: entry.late for name, entry in document.requirements.items() if entry.late}
    return replace(report, misses=misses, late=late, goals=document.goals, law=document.law)
