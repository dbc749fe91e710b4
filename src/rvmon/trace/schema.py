"""What a spec says of the names in a trace, as far as reading them needs it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from rvmon.trace.binding import BY_NAME, Binding
from rvmon.trace.gaps import NO_GAPS, Gaps


class Kind(StrEnum):
    """What values a signal or a payload field takes."""

    BOOL = "bool"
    INT = "int"
    REAL = "real"
    LABEL = "label"


@dataclass(frozen=True, slots=True)
class Stamps:
    """Where a recording says when.

    Attributes:
        column: the name of the column, in JSON lines of the field.
        unit: `s`, `ms`, `us`, `ns`, or `iso` for dates and times of ISO 8601.
        is_stated: whether a person named the unit, or it is what goes without saying.
        pattern: of dates that are no ISO 8601, as `datetime.strptime` takes it.
    """

    column: str
    unit: str
    is_stated: bool = False
    pattern: str = ""


@dataclass(frozen=True, slots=True)
class Schema:
    """The declared names with their kinds, and how recordings give them.

    Attributes:
        signals: kind by name.
        events: for each event the kinds of its payload's fields.
        ignoring: the signals of which NaN and null are no update.
        stamps: of recordings; `None`: seconds in `t`, or nanoseconds in `t_ns`.
        columns: by declared name (of an event's field `event.field`) the column that stands for
            it, where that has another name.
        gaps: values that stand for no update, of whatever name.
        binding: which topics and fields of messages stand for what.
        units: in which the declared names are, of an event's field by `event.field`; those
            without one are not in it.
    """

    signals: Mapping[str, Kind]
    events: Mapping[str, Mapping[str, Kind]]
    ignoring: frozenset[str] = frozenset()
    stamps: Stamps | None = None
    columns: Mapping[str, str] = field(default_factory=dict)
    gaps: Gaps = NO_GAPS
    binding: Binding = BY_NAME
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def named(self) -> Mapping[str, str]:
        """By declared name the column or topic that a person named for it."""
        topics = {name: bound.topic for name, bound in self.binding.bounds.items()}
        return {**topics, **self.columns}
