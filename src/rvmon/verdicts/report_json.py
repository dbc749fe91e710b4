"""Reports as JSON and back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

import msgspec

from rvmon.errors import TraceError
from rvmon.trace.sample import Health
from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.verdicts import LAW, Verdict
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.run_coverage import CoveredGroup, IllegalHit

if TYPE_CHECKING:
    from rvmon.language.checked.specification import Requirement


_ALWAYS = ("number", "triggered", "decided", "verdict", "decision", "reason")
"""Keys that every attempt has in JSON; others are omitted if empty."""

_UNLESS_EMPTY = ("at_trigger", "at_decision", "required", "captured", "blame", "forecast")


def packed(attempt: Attempt) -> msgspec.Raw:
    """The `record` of an attempt as text within JSON: of many, the objects would take much more."""
    return msgspec.Raw(msgspec.json.encode(record(attempt)))


def record(attempt: Attempt) -> dict[str, object]:
    """The JSON object of an attempt, without requirement and origin.

    Instants are in ticks, and under keys ending in `_s` in seconds since the origin.
    """
    shown: dict[str, object] = {name: getattr(attempt, name) for name in _ALWAYS}
    if attempt.deadline is not None:
        shown["deadline"] = attempt.deadline
    for name in _UNLESS_EMPTY:
        if value := getattr(attempt, name):
            shown[name] = value
    if attempt.robustness is not None:
        shown["robustness"] = attempt.robustness
    if attempt.in_doubt:
        shown["in_doubt"] = True
    return shown | seconds(attempt)


def seconds(attempt: Attempt) -> dict[str, float | None]:
    """The trigger and the decision of an attempt in seconds since the origin of its run."""
    origin, decided = attempt.origin, attempt.decided
    return {
        "triggered_s": (attempt.triggered - origin) / TICKS_PER_SECOND,
        "decided_s": None if decided is None else (decided - origin) / TICKS_PER_SECOND,
    }


def encoded(value: object) -> str:
    """A value as JSON text."""
    return msgspec.json.encode(value).decode()


class RequirementJson(msgspec.Struct):
    """One requirement of a report."""

    attempts: list[dict[str, Any]]
    verdict: Verdict
    nearest_miss: str = ""
    late: dict[int, int] = {}
    values: dict[int, dict[str, str]] = {}
    dropped: dict[Literal["P", "F", "I"], Annotated[int, msgspec.Meta(gt=0)]] = {}


class ReportJson(msgspec.Struct):
    """The JSON document of a report; counts are not read but recomputed."""

    requirements: dict[str, RequirementJson]
    health: list[Health]
    law: int = 1  # version 1 did not write it
    trace: str = ""
    origin: int = 0
    end: int | None = None
    goals: dict[str, Verdict] = {}
    illegal: tuple[IllegalHit, ...] = ()
    coverage: tuple[CoveredGroup, ...] = ()


def labels(requirement: Requirement | None) -> dict[str, object]:
    """A requirement's severity and tags, as far as it has them."""
    if requirement is None:
        return {}
    members = {"severity": requirement.severity, "tags": requirement.tags}
    return {name: value for name, value in members.items() if value}


def encode_broken(trace: str, error: str, before: Sequence[Attempt]) -> str:
    """Write as JSON text the error of a recording that broke off, and the attempts before it.

    It has no verdicts: later samples could have changed them.
    """
    attempts: dict[str, list[dict[str, object]]] = {}
    for attempt in before:
        attempts.setdefault(attempt.requirement, []).append(record(attempt))
    return encoded({"law": LAW, "trace": trace, "error": error, "judged_before": attempts})


def decode(text: str | bytes) -> tuple[ReportJson, list[Attempt]]:
    """Read the document and the attempts of a report written by `encode`.

    Raises:
        TraceError: the text is no report.
    """
    try:
        document = msgspec.json.decode(text, type=ReportJson)
        attempts = [
            msgspec.convert(shown | {"requirement": name, "origin": document.origin}, Attempt)
            for name, entry in document.requirements.items()
            for shown in entry.attempts
        ]
    except (msgspec.DecodeError, msgspec.ValidationError, UnicodeDecodeError) as error:
        raise TraceError(f"this is no report of rvmon: {error}") from None
    return document, attempts
