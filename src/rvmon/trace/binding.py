"""Which topic and field of recorded messages feed a signal or an event."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any


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

    Attributes:
        array: the field.

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
        if self.sign == "yaw":
            return f"yaw({args[0].rpartition('.')[0]})"
        if re.fullmatch(r"\w+", self.sign) and self.sign not in ("and", "or", "xor"):
            return f"{self.sign}({', '.join(args)})"
        return f"({f' {self.sign} '.join(args)})" if len(args) > 1 else f"{self.sign}{args[0]}"


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
