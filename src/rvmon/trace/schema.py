"""What a spec says of the names in a trace, as far as reading them needs it.

A name may be bound to a topic and a field of recorded messages, and to what stands for "no update".
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from rvmon.errors import UnknownNameError


class Clock(StrEnum):
    """Which of the stamps of a message counts: when it was recorded, or what its header says."""

    LOG = "log"
    HEADER = "header"


@dataclass(frozen=True, slots=True)
class Named:
    """The element of an array that has a name: beside the array, or in the element itself."""

    name: str

    def __str__(self) -> str:
        return self.name


Step = str | int | Named


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a message.

    Attributes:
        path: names that lead to it, and the places or names of elements of arrays.

    >>> str(Field(("poses", 0, "position", "x"))), str(Field(("position", Named("elbow"))))
    ('poses[0].position.x', 'position[elbow]')
    """

    path: tuple[Step, ...]

    def __str__(self) -> str:
        steps = (f".{step}" if isinstance(step, str) else f"[{step}]" for step in self.path)
        return "".join(steps).removeprefix(".")


@dataclass(frozen=True, slots=True)
class Elements:
    """All elements of an array.

    >>> str(Elements(Field(("ranges",))))
    'ranges[]'
    """

    array: Field

    def __str__(self) -> str:
        return f"{self.array}[]"


@dataclass(frozen=True, slots=True)
class Constant:
    """A number, or a truth value."""

    value: float | int | bool

    def __str__(self) -> str:
        return str(self.value).lower()


@dataclass(frozen=True, slots=True)
class Applied:
    """An operation on terms, of which `Elements` is alone; what is no number is unknown.

    Attributes:
        operation: yields the result.
        args: on what.
        sign: as it is written; empty of a conversion of units.
    """

    operation: Callable[..., Any]
    args: tuple[Term, ...]
    sign: str

    def __str__(self) -> str:
        args = [str(arg).removesuffix("[]") for arg in self.args]
        if not self.sign:
            return args[0]
        if self.sign in TURNS:
            return f"{self.sign}({args[0].rpartition('.')[0]})"
        if re.fullmatch(r"\w+", self.sign) and self.sign not in ("and", "or", "xor"):
            return f"{self.sign}({', '.join(args)})"
        return f"({f' {self.sign} '.join(args)})" if len(args) > 1 else f"{self.sign}{args[0]}"


TURNS = ("yaw", "pitch", "roll")
"""Functions of a quaternion: its turns about z, y and x."""

Term = Field | Elements | Constant | Applied


@dataclass(frozen=True, slots=True)
class Bound:
    """What feeds a signal or an event.

    Attributes:
        topic: of the messages.
        value: of a signal its value, of an event whether it occurs; `None`: an event occurs with
            each message.
        fields: of an event's payload, by name.
        labels: of a signal of labels, by the number or text that stands for it; empty: the text.
        clock: which stamp counts; `None`: that of the whole recording.
        on_change: whether a message whose value is that of the one before says nothing.
        type: of the messages; empty: any.
        unit: of the value, before it is converted; empty: the declared one.
    """

    topic: str
    value: Term | None = None
    fields: Mapping[str, Term] = field(default_factory=dict)
    labels: Mapping[str, str] = field(default_factory=dict)
    clock: Clock | None = None
    on_change: bool = False
    type: str = ""
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Binding:
    """How recorded messages are read.

    Attributes:
        bounds: by declared name.
        clock: which stamps count.
        definitions: texts of message definitions by type, for recordings that bring none along.
        robot: what stands for `*` in the names of topics; empty: what the recording has.
    """

    bounds: Mapping[str, Bound] = field(default_factory=dict)
    clock: Clock = Clock.LOG
    definitions: Mapping[str, str] = field(default_factory=dict)
    robot: str = ""


BY_NAME = Binding()
"""Names lead to topics and fields, and what was recorded when counts."""


READINGS_OF_NAN = ("unknown", "no update")
"""What NaN may say of a name: that it became unknown, or nothing."""


@dataclass(frozen=True, slots=True)
class Gaps:
    """Values that say nothing of their name.

    Attributes:
        no_update: a value; `None`: no further one.
        nan: whether NaN is one.
    """

    no_update: bool | int | float | str | None = None
    nan: bool = False

    def __bool__(self) -> bool:
        return self.nan or self.no_update is not None

    @property
    def reading_of_nan(self) -> str:
        """One of `READINGS_OF_NAN`."""
        return READINGS_OF_NAN[self.nan]

    def holds(self, value: Any) -> bool:
        """Whether a value of a cell, or of a sample, says nothing.

        >>> Gaps(no_update=-1).holds(-1.0), Gaps(no_update=1).holds(True), Gaps(nan=True).holds(2)
        (True, False, False)
        """
        if isinstance(value, float) and value != value:
            return self.nan
        if self.no_update is None or not isinstance(value, bool | int | float | str):
            return False
        same_kind = isinstance(value, bool) == isinstance(self.no_update, bool)
        return same_kind and value == self.no_update


def is_unknown(value: Any) -> bool:
    """Whether the value of a sample is none: NaN, or nothing."""
    return value is None or (isinstance(value, float) and value != value)


NO_GAPS = Gaps()
"""Only what is absent says nothing."""


def gaps_of(nan: str, no_update: Any) -> Gaps:
    """What a caller names.

    Args:
        nan: one of `READINGS_OF_NAN`.
        no_update: a value, NumPy's too; NaN is as good as `nan="no update"`; `None`: no further.

    Raises:
        UnknownNameError: there is no such reading of NaN, or the value is none that a cell holds.
    """
    if nan not in READINGS_OF_NAN:
        known = " or ".join(f"nan={one!r}" for one in READINGS_OF_NAN)
        raise UnknownNameError(f"no reading of NaN {nan!r}: there is {known}")
    value = no_update.item() if hasattr(no_update, "item") else no_update
    if not isinstance(value, bool | int | float | str | None):
        raise UnknownNameError(
            f"no_update={no_update!r} is no value of a cell: give a number, a text or a truth value"
        )
    if value is not None and value != value:
        return Gaps(nan=True)
    return Gaps(value, nan == READINGS_OF_NAN[True])


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
