"""All mistakes of a `.ta` text that keep it from being read, not only the first."""

from __future__ import annotations

import re
from collections.abc import Callable

from rvmon.diagnostics import Diagnostic
from rvmon.errors import ModelError

MOST = 20
"""Behind so many, nothing more is looked for: the text is read again for each."""

LONGEST = 100_000
"""Of a longer text the first mistake is told: reading it again and again takes too long."""

_ALONE = r"(?:(?:urgent|committed)[ \t]+)?location|edge|start|query|signal"
_OTHERS = "automaton|clock|broadcast|chan|int|bool|const|typedef|unit|system|network"
_BEGINS = re.compile(rf"^[ \t]*(?:(?P<alone>{_ALONE})\b|(?:{_OTHERS})\b|\}})", re.MULTILINE)
"""Lines that begin something. What stands `alone` can be left out, and the rest is still a text."""


def all_mistakes(
    text: str, first: ModelError, read: Callable[[str], object]
) -> tuple[Diagnostic, ...]:
    """The mistakes that are found when each part with one is left out in turn."""
    found = list(first.diagnostics)
    error: ModelError | None = first
    while error is not None and len(found) < MOST and len(text) <= LONGEST:
        at = _place(error)
        error = None
        for start, end in [] if at is None else _suspects(text, at):
            left = text[:start] + re.sub(r"\S", " ", text[start:end]) + text[end:]
            following = _tried(left, read)
            if following is None or (_place(following) or 0) > (at or 0):
                text, error = left, following
                break
        if error is not None:
            found += error.diagnostics
    return tuple(found)


def _tried(text: str, read: Callable[[str], object]) -> ModelError | None:
    try:
        read(text)
    except ModelError as error:
        return error
    return None


def _place(error: ModelError) -> int | None:
    """Where the mistake stands."""
    spans = error.diagnostics[0].spans
    return spans[0].span.start if spans else None


def _suspects(text: str, at: int) -> list[tuple[int, int]]:
    """Parts that may hold the mistake: the one before, which may be cut short, and that around."""
    begins = [match for match in _BEGINS.finditer(text) if match.start() <= at]
    around = [match.start() for match in begins[1:]] + [_end(text, at)]
    parts = list(zip(begins, around, strict=False))[-2:]  # there may be none
    return [(match.start(), end) for match, end in parts if match["alone"]]


def _end(text: str, at: int) -> int:
    """Where the next part begins."""
    following = _BEGINS.search(text, text.find("\n", at) + 1 or len(text))
    return following.start() if following else len(text)
