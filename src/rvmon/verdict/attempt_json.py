"""Attempts as JSON text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields

import msgspec

from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.verdict.attempt import Attempt

_ALWAYS = frozenset({"number", "triggered", "decided", "verdict", "decision", "reason"})
"""Keys that every attempt has in JSON; the others are left out where they are empty."""

_NAMES = tuple(one.name for one in fields(Attempt) if one.name != "requirement")

_DIFFERING = ("number", "triggered", "decided", "deadline", "triggered_s", "decided_s")
"""What attempts that are alike differ in, beside places in the reason."""


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


def numbers_texts(numbers: list[float]) -> list[str]:
    """The JSON text of each number."""
    found = encoded(numbers)[1:-1]
    return found.split(",") if found else []


class Pattern:
    """The JSON text of attempts that are alike.

    Args:
        attempt: one of them.
        reason: its reason in parts; `None` where the others may have another text.
    """

    def __init__(self, attempt: Attempt, reason: Sequence[str | None]) -> None:
        parts = []
        self._slots: list[str] = []
        for name, value in timed_record(attempt, 0).items():
            if name == "reason":
                text = "".join("%s" if part is None else _plain(part)[1:-1] for part in reason)
                parts.append(f'"reason":"{text}"')
                self._slots += ["reason"] * reason.count(None)
            elif name in _DIFFERING and value is not None:
                parts.append(f'"{name}":%s')
                self._slots.append(name)
            else:
                parts.append(f'"{name}":{_plain(value)}')
        self._template = "{" + ",".join(parts) + "}"

    def texts(
        self, columns: Mapping[str, Iterable[object]], places: Iterable[Iterable[str]]
    ) -> list[str]:
        """The texts of some of the attempts.

        Args:
            columns: by key of the record what they differ in, for each; numbers or their JSON text.
            places: for each `None` of the reason the texts that stand there, for each.
        """
        texts = iter(places)
        found = [next(texts) if slot == "reason" else columns[slot] for slot in self._slots]
        return list(map(self._template.__mod__, zip(*found, strict=True)))


def _plain(value: object) -> str:
    return encoded(value).replace("%", "%%")
