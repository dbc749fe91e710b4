"""Attempts as JSON text."""

from __future__ import annotations

from dataclasses import fields

import msgspec

from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.verdict.attempt import Attempt

_ALWAYS = frozenset({"number", "triggered", "decided", "verdict", "decision", "reason"})
"""Keys that every attempt has in JSON; the others are left out where they are empty."""

_NAMES = tuple(one.name for one in fields(Attempt) if one.name != "requirement")


def record(attempt: Attempt) -> dict[str, object]:
    """An attempt by the keys that it has in JSON; its requirement stands elsewhere."""
    shown: dict[str, object] = {}
    for name in _NAMES:
        value = getattr(attempt, name)
        if name in _ALWAYS or (value not in (None, "", {}) and value is not False):
            shown[name] = value
    return shown


def timed_record(attempt: Attempt, origin: int) -> dict[str, object]:
    """The same, and its instants in seconds after the origin (ticks)."""
    shown = record(attempt)
    shown["triggered_s"] = seconds(attempt.triggered, origin)
    shown["decided_s"] = None if attempt.decided is None else seconds(attempt.decided, origin)
    return shown


def seconds(instant: int, origin: int) -> float:
    """An instant in seconds after the origin; both in ticks."""
    return (instant - origin) / TICKS_PER_SECOND


def attempt_text(attempt: Attempt, origin: int) -> str:
    """The JSON text of an attempt; its requirement is not part of it."""
    return encoded(timed_record(attempt, origin))


def encoded(value: object) -> str:
    """A value as JSON text."""
    return msgspec.json.encode(value).decode()
