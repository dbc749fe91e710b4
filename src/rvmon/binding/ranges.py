"""The ranges of values in a recording, and the first of them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from rvmon.binding.candidates import Candidate
from rvmon.binding.expression import term_of
from rvmon.errors import TraceError
from rvmon.readers.messages.by_names import Get
from rvmon.readers.messages.fields import getter
from rvmon.readers.messages.file import MessageFile
from rvmon.readers.messages.look import MOST
from rvmon.readers.values import plain, shorten

_FIRST = 3
"""Values that are shown."""


@dataclass(slots=True)
class Range:
    """What a value was.

    Attributes:
        count: of messages that had it.
        first: the first values, each once.
        low: the least number; `None` if there was none.
        high: the greatest.
    """

    count: int = 0
    first: list[Any] = field(default_factory=list)
    low: float | None = None
    high: float | None = None

    def add(self, value: Any) -> None:
        """Take the value of a message."""
        if value is None or value != value:
            return
        self.count += 1
        if value not in self.first and len(self.first) < _FIRST:
            self.first.append(value)
        if isinstance(value, int | float) and not isinstance(value, bool):
            self.low = value if self.low is None else min(self.low, value)
            self.high = value if self.high is None else max(self.high, value)

    def __str__(self) -> str:
        if not self.count:
            return "no value"
        first = ", ".join(_shown(value) for value in self.first)
        if self.low is None or self.high is None:
            return f"first {first}"
        if self.low == self.high:
            return f"always {_shown(self.low)}"
        return f"{_shown(self.low)} … {_shown(self.high)}, first {first}"


def _shown(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return f"{value + 0:.6g}"  # without the sign of -0
    return shorten(str(value))


def ranges_of(
    source: MessageFile, candidates: Iterable[Candidate]
) -> Mapping[tuple[str, str], Range]:
    """By topic and value, what the values of these were."""
    ranges: dict[tuple[str, str], Range] = {}
    readers: dict[str, list[tuple[Range, Get]]] = defaultdict(list)
    for one in candidates:
        key = one.topic.name, one.value
        if one.value and key not in ranges:
            ranges[key] = Range()
            readers[one.topic.name].append((ranges[key], _reading(one.value)))
    with suppress(TraceError):
        for number, (topic, _, content) in enumerate(source.read(set(readers))):
            if number == MOST:
                break
            for kept, read in readers[topic]:
                with suppress(KeyError, TraceError):
                    kept.add(plain(read(content)))
    return ranges


def _reading(value: str) -> Get:
    term = term_of(value)
    by_name, by_key = getter(term, mappings=False), getter(term, mappings=True)
    return lambda content: (by_key if isinstance(content, Mapping) else by_name)(content)
