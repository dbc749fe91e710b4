"""The schema of a trace: the declarations of a specification that readers need.

A schema also binds names to topics and fields of recorded messages, and defines which values mean
"no update".
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import Any

from msgspec import Struct, field

from rvmon.errors import UnknownNameError
from rvmon.trace import READINGS_OF_NAN


class Clock(StrEnum):
    """Which stamp of a message is its time: that of the log, or that in its header."""

    LOG = "log"
    HEADER = "header"


class Named(Struct, frozen=True):
    """An array element chosen by name; a parallel array or the element itself holds the name."""

    name: str

    def __str__(self) -> str:
        return self.name


Step = str | int | Named


class Field(Struct, frozen=True):
    """A field of a message.

    >>> str(Field(("poses", 0, "position", "x"))), str(Field(("position", Named("elbow"))))
    ('poses[0].position.x', 'position[elbow]')
    """

    path: tuple[Step, ...]  # names of nested fields, and indices or names of array elements

    def __str__(self) -> str:
        steps = (f".{step}" if isinstance(step, str) else f"[{step}]" for step in self.path)
        return "".join(steps).removeprefix(".")


class Elements(Struct, frozen=True):
    """All elements of an array.

    >>> str(Elements(Field(("ranges",))))
    'ranges[]'
    """

    array: Field

    def __str__(self) -> str:
        return f"{self.array}[]"


class Constant(Struct, frozen=True):
    """A constant number or truth value."""

    value: float | int | bool

    def __str__(self) -> str:
        return str(self.value).lower()


class Applied(Struct, frozen=True):
    """An operation on terms; `Elements` can only be its sole argument. Non-numbers are unknown."""

    operation: Callable[..., Any]  # computes the result
    args: tuple[Term, ...]  # the operands
    sign: str  # its sign or name; "" for a conversion of units

    def __str__(self) -> str:
        args = [str(arg).removesuffix("[]") for arg in self.args]
        if not self.sign:
            return args[0]
        if self.sign in TURNS:
            return f"{self.sign}({args[0].rpartition('.')[0]})"
        if re.fullmatch(r"\w+", self.sign) and self.sign not in ("and", "or", "xor"):
            return f"{self.sign}({', '.join(args)})"
        return f"({f' {self.sign} '.join(args)})" if len(args) > 1 else f"{self.sign}{args[0]}"


TURNS = ("yaw", "pitch", "roll")  # functions of a quaternion: its rotations about z, y and x

Term = Field | Elements | Constant | Applied


class Bound(Struct, frozen=True):
    """The source of a signal or event in recorded messages."""

    topic: str  # the topic of the messages
    # the value of a signal, or whether an event occurs; `None`: an event occurs with each message
    value: Term | None = None
    # of an event, the terms of its payload by field
    fields: Mapping[str, Term] = field(default_factory=dict)
    # of a signal of labels, the label by recorded number or text; empty: the text itself
    labels: Mapping[str, str] = field(default_factory=dict)
    # the stamp that is the time of a message; `None`: the one chosen for the whole recording
    clock: Clock | None = None
    # whether a message with the same value as the previous one is no update
    on_change: bool = False
    type: str = ""  # the type of the messages; "": any
    unit: str = ""  # the unit of the recorded value; "": the declared one


class Binding(Struct, frozen=True):
    """The sources of declared names in recorded messages."""

    bounds: Mapping[str, Bound] = field(default_factory=dict)  # by declared name, its source
    clock: Clock = Clock.LOG  # the stamps that are the time of messages
    # by type, texts of message definitions, for recordings without them
    definitions: Mapping[str, str] = field(default_factory=dict)
    robot: str = ""  # the replacement of `*` in the names of topics; "": taken from the recording


BY_NAME = Binding()
"""The default binding: names are matched with topics and fields, and times are those of the log."""


class Gaps(Struct, frozen=True):
    """Values that mean "no update"."""

    no_update: bool | int | float | str | None = None  # such a value; `None`: there is none
    nan: bool = False  # whether NaN means "no update"

    def __bool__(self) -> bool:
        return self.nan or self.no_update is not None

    @property
    def reading_of_nan(self) -> str:
        """One of `READINGS_OF_NAN`."""
        return READINGS_OF_NAN[self.nan]

    def holds(self, value: Any) -> bool:
        """Whether a value of a cell or sample means "no update".

        >>> Gaps(no_update=-1).holds(-1.0), Gaps(no_update=1).holds(True), Gaps(nan=True).holds(2)
        (True, False, False)
        """
        if isinstance(value, float) and value != value:
            return self.nan
        if self.no_update is None or not isinstance(value, bool | int | float | str):
            return False
        # In Python `True == 1`, but here a truth value is no number.
        same_kind = isinstance(value, bool) == isinstance(self.no_update, bool)
        return same_kind and value == self.no_update


def is_unknown(value: Any) -> bool:
    """Whether a value in a sample makes its name unknown: NaN or `None`."""
    return value is None or (isinstance(value, float) and value != value)


NO_GAPS = Gaps()  # only an absent value means "no update"


def gaps_of(nan: str, no_update: Any) -> Gaps:
    """The gaps from a caller's options.

    Args:
        nan: one of `READINGS_OF_NAN`.
        no_update: a value, also of NumPy; NaN is the same as `nan="no update"`.

    Raises:
        UnknownNameError: `nan` is no known reading, or no cell can have the value `no_update`.
    """
    if nan not in READINGS_OF_NAN:
        expected = " or ".join(map(repr, READINGS_OF_NAN))
        raise UnknownNameError(f"nan={nan!r}: expected {expected}")
    value = no_update.item() if hasattr(no_update, "item") else no_update
    if not isinstance(value, bool | int | float | str | None):
        raise UnknownNameError(
            f"no_update={no_update!r} is not a value of a cell: give a number, text or truth value"
        )
    if value is not None and value != value:
        return Gaps(nan=True)
    return Gaps(value, nan == READINGS_OF_NAN[True])


class Kind(StrEnum):
    """The kind of the values of a signal or payload field."""

    BOOL = "bool"
    INT = "int"
    REAL = "real"
    LABEL = "label"


class Stamps(Struct, frozen=True):
    """The source of the stamps of a recording."""

    column: str  # the name of the column, or of the field in JSON lines
    unit: str  # `s`, `ms`, `us`, `ns`, or `iso` for dates and times of ISO 8601
    is_stated: bool = False  # whether the user named the unit; otherwise it is a default
    pattern: str = ""  # the format of dates that are not ISO 8601, for `datetime.strptime`


@dataclasses.dataclass(frozen=True, slots=True)
class Schema:
    """The declared names with their kinds, and how recordings provide them."""

    signals: Mapping[str, Kind]  # kind by name
    events: Mapping[str, Mapping[str, Kind]]  # by event, the kinds of its payload's fields
    ignoring: frozenset[str] = frozenset()  # the signals for which NaN and null are no update
    # the source of stamps; `None`: seconds in `t`, or nanoseconds in `t_ns`
    stamps: Stamps | None = None
    # by declared name (`event.field` for a field), the column, if it has another name
    columns: Mapping[str, str] = dataclasses.field(default_factory=dict)
    gaps: Gaps = NO_GAPS  # values that mean "no update", for all names
    binding: Binding = BY_NAME  # the topics and fields of messages by name
    # the unit of each declared name (`event.field` for a field) that has one
    units: Mapping[str, str] = dataclasses.field(default_factory=dict)
    # cache: the layout of the last CSV header by its raw bytes, as many recordings share a header
    layouts: dict[bytes, Any] = dataclasses.field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    @property
    def aliases(self) -> dict[str, str]:
        """The declared name by column, for columns with another name.

        A declared name that is mapped to another column maps to "": a column of that name is no
        longer read for it.

        >>> Schema({}, {}, columns={"speed": "Speed [m/s]"}).aliases
        {'speed': '', 'Speed [m/s]': 'speed'}
        """
        aliases = {column: name for name, column in self.columns.items()}
        return {**dict.fromkeys(self.columns, ""), **aliases}

    @property
    def named(self) -> Mapping[str, str]:
        """By declared name, the column or topic that the user mapped to it."""
        topics = {name: bound.topic for name, bound in self.binding.bounds.items()}
        return {**topics, **self.columns}
