"""Verdicts as rows of a table: one for each attempt, and one for whatever has none."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import msgspec

from rvmon.verdict.attempt import Attempt
from rvmon.verdict.attempt_json import encoded, seconds


class VerdictRow(NamedTuple):
    """An attempt; or a requirement that has none in a recording; or a recording without verdicts.

    Attributes:
        recording: its name.
        requirement: its id; `None` where the recording has no verdicts.
        attempt: its name as people say it, such as `R1#3`; `None` where there is none.
        number: from 1 per requirement; attempts in doubt have numbers of their own.
        verdict: `P`, `F` or `I` of an attempt, `NT` or `I` of a requirement without one; `None`
            where the recording has none.
        decision: what settled the attempt, as `rvmon.verdict.attempt.Decision` has it.
        in_doubt: whether it is not known that there was a trigger.
        triggered: ns.
        decided: ns; `None` if it is not.
        deadline: ns, where there is one.
        triggered_s: seconds since the recording's origin.
        decided_s: likewise.
        robustness: SI units, where somebody measured.
        captured: values captured by `let` and `for each`, as JSON; empty if there are none.
        reason: one sentence for people.
        error: what was wrong with a recording without verdicts; else empty.
    """

    recording: str
    requirement: str | None = None
    attempt: str | None = None
    number: int | None = None
    verdict: str | None = None
    decision: str | None = None
    in_doubt: bool = False
    triggered: int | None = None
    decided: int | None = None
    deadline: int | None = None
    triggered_s: float | None = None
    decided_s: float | None = None
    robustness: float | None = None
    captured: str = ""
    reason: str = ""
    error: str = ""


def broken_rows(recording: str, error: str, before: Iterable[Attempt]) -> Iterator[VerdictRow]:
    """The rows of a recording that broke off: that it did, then what was decided before.

    Its attempts have no seconds, as these are counted from an origin that is known at the end only.
    """
    yield VerdictRow(recording, error=error)
    for attempt in before:
        yield attempt_row(recording, None, attempt)._replace(error=error)


def attempt_row(recording: str, origin: int | None, attempt: Attempt) -> VerdictRow:
    """The row of an attempt.

    Args:
        recording: its name.
        origin: the instant from which people count seconds, ticks; `None` if that is not known.
        attempt: what the row says.
    """
    decided = attempt.decided
    return VerdictRow(
        recording,
        attempt.requirement,
        attempt.name,
        attempt.number,
        attempt.verdict.value,
        attempt.decision.value,
        attempt.in_doubt,
        attempt.triggered,
        decided,
        attempt.deadline,
        None if origin is None else seconds(attempt.triggered, origin),
        None if origin is None or decided is None else seconds(decided, origin),
        attempt.robustness,
        encoded(attempt.captured) if attempt.captured else "",
        attempt.reason,
    )


class _Text(msgspec.Struct):
    """What of an attempt's JSON text a row has."""

    number: int
    triggered: int
    decided: int | None
    verdict: str
    decision: str
    reason: str
    triggered_s: float
    decided_s: float | None
    deadline: int | None = None
    in_doubt: bool = False
    robustness: float | None = None
    captured: msgspec.Raw = msgspec.Raw()


_decoder = msgspec.json.Decoder(_Text)


def text_row(recording: str, requirement: str, text: str) -> VerdictRow:
    """The row of an attempt that is there as JSON text.

    Args:
        recording: its name.
        requirement: the id.
        text: as `rvmon.verdict.attempt_json.attempt_text` writes it.
    """
    fields = _decoder.decode(text)
    return VerdictRow(
        recording,
        requirement,
        f"{requirement}{'?' if fields.in_doubt else '#'}{fields.number}",
        fields.number,
        fields.verdict,
        fields.decision,
        fields.in_doubt,
        fields.triggered,
        fields.decided,
        fields.deadline,
        fields.triggered_s,
        fields.decided_s,
        fields.robustness,
        bytes(fields.captured).decode(),
        fields.reason,
    )
