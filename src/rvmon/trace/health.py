"""Input health: why something was not known (SEMANTICS 1 and 6)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class HealthKind(StrEnum):
    """A cause of not knowing."""

    MISSING = "missing"
    ABSENT = "absent"
    NAN = "nan"
    NONE = "none"
    STALE = "stale"
    LATE = "late"
    CONFLICT = "conflict"
    IGNORED = "ignored"
    DROPPED = "dropped"
    UNIT = "unit"
    CLOCK = "clock"
    INTERRUPTED = "interrupted"
    CUT = "cut off"


@dataclass(frozen=True, slots=True)
class Health:
    """One kind of trouble with one input on one run.

    Attributes:
        kind: what it was.
        name: the signal or event, or the column.
        count: how often.
        first: the first instant, ticks; `None` if it has none.
        requirements: ids of the requirements that read the name.
        remark: more for people, or empty.
    """

    kind: HealthKind
    name: str
    count: int = 1
    first: int | None = None
    requirements: tuple[str, ...] = ()
    remark: str = ""
