"""What a spec says of the names in a trace, as far as reading them needs it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum


class Kind(StrEnum):
    """What values a signal or a payload field takes."""

    BOOL = "bool"
    INT = "int"
    REAL = "real"
    LABEL = "label"


@dataclass(frozen=True, slots=True)
class Schema:
    """The declared names with their kinds.

    Attributes:
        signals: kind by name.
        events: for each event the kinds of its payload's fields.
        ignoring: the signals of which NaN and null are no update.
    """

    signals: Mapping[str, Kind]
    events: Mapping[str, Mapping[str, Kind]]
    ignoring: frozenset[str] = frozenset()
