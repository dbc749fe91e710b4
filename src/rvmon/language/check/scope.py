"""The values of expressions under check, and the scopes and table in which names are looked up."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Protocol

from msgspec import Struct, field
from msgspec.structs import replace

from rvmon.diagnostics import Span
from rvmon.language.checked import formula as rv
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.specification import Capture, Event, Signal, TimeModel, Type
from rvmon.language.names import Declared
from rvmon.language.syntax.expressions import Expression
from rvmon.texts import nearest
from rvmon.trace.schema import Kind
from rvmon.units import PLAIN, Unit, unit_table


class Quantity(Struct, frozen=True):
    """A number or label with its unit."""

    # the expression that yields it at run time; `None` if it is a constant
    node: rv.Numeric | None = None
    constant: Fraction | None = None  # the exact value in `unit` if it is a constant
    unit: Unit = PLAIN  # of the value
    integral: bool = False  # whether all values are whole numbers by type
    labels: tuple[str, ...] = ()  # the labels it may take, if it is one
    truth: bool = False  # whether it is a bool, for which 0 and 1 stand
    lone: Lone | None = None  # the window that it is, if it is no expression of one


def typed(node: rv.Numeric, type_: Type, unit: Unit) -> Quantity:
    """What an expression of a declared type yields."""
    return Quantity(
        node, unit=unit, integral=type_.kind is Kind.INT,
        labels=type_.labels, truth=type_.kind is Kind.BOOL,
    )  # fmt: skip


class Age(Struct, frozen=True):
    """`age(x)`: the time since the last update; only compared with durations."""

    name: str


class Chosen(Struct, frozen=True):
    """`if φ then x else y` of numbers; a comparison of it becomes one of each, with φ."""

    condition: rv.Formula
    chosen: Value
    otherwise: Value


class Now(Struct, frozen=True):
    """`now`, `now - t0`: the time since an instant, else the first; only compared, or captured."""

    since: str | None = None


class Moment(Struct, frozen=True):
    """An instant that was captured, or so much `later`; `now` is compared with it."""

    name: str
    later: Quantity | None = None


class Lone(Struct, frozen=True):
    """A number that is just a window; with a limit it has a comparison of its own."""

    of: rv.WindowValue  # the window; of a share, its duration
    added: Quantity | None = None  # its x, if it is of numbers
    share: bool = False  # whether it is divided by D
    # the condition that the trigger has come, if only members since then count
    begun: rv.Formula | None = None


TimeValue = Age | Now | Moment
"""The values of time, which are only allowed as one side of a comparison."""

Value = rv.Formula | Quantity | TimeValue | Chosen


class Closure(Struct, frozen=True):
    """A macro's argument: an expression that keeps the names of the place it was written at."""

    expression: Expression
    scope: Scope


class AtTrigger(Struct, frozen=True):
    """Values captured at the trigger besides `let`, as far as the consequent reads them."""

    captures: list[Capture] = field(default_factory=list)

    def begun(self, span: Span) -> rv.Passed:
        """The condition that the trigger has come."""
        if not any(capture.name == rv.TRIGGERED for capture in self.captures):
            self.captures.append(Capture(rv.TRIGGERED, rv.NowValue()))
        return rv.since_trigger(span)

    def number(self, word: str, value: rv.Numeric) -> str:
        """The name of a number of that instant, which begins as a word of the language does."""
        for capture in self.captures:
            if capture.value == value and capture.name.startswith(word):
                return capture.name
        # A keyword, or a name with a space: no `let` can declare it.
        taken = sum(capture.name.startswith(word) for capture in self.captures)
        self.captures.append(Capture(f"{word} {taken + 1}" if taken else word, value))
        return self.captures[-1].name


class Scope(Struct, frozen=True):
    """The names that hold inside a macro or requirement, besides those of the file."""

    # by name, its meaning
    names: Mapping[str, Closure | Quantity | Moment] = field(default_factory=dict)
    trigger: AtTrigger | None = None  # in what is required, what is captured with it
    at_once: bool = False  # whether it is required at the trigger, and not at some later instant

    def later(self) -> Scope:
        """The same below an operator of time."""
        return replace(self, at_once=False) if self.at_once else self

    def inside(self, names: Mapping[str, Closure]) -> Scope:
        """The scope of the body of a macro."""
        return Scope(names, self.trigger, self.at_once)


EVERYWHERE = Scope()  # only the names of the file


_LONG_NAMES = {
    "metre": "m", "meter": "m", "millimetre": "mm", "millimeter": "mm", "second": "s", "sec": "s",
    "millisecond": "ms", "msec": "ms", "minute": "min", "hour": "h", "hr": "h", "gram": "g",
    "kilogram": "kg", "kilo": "kg", "newton": "N", "radian": "rad", "degree": "deg", "°": "deg",
    "turn": "rev", "celsiu": "degC", "kelvin": "K", "volt": "V", "amp": "ampere", "hertz": "Hz",
    "percent": "%", "mp": "m/s", "kmh": "km/h", "kph": "km/h", "pixel": "px", "byte": "B",
}  # fmt: skip
"""By what people write for a unit, in lower case and without a last `s`: its symbol."""


class Table(Struct, frozen=True):
    """The declarations of a file, by name."""

    time: TimeModel
    signals: Mapping[str, Signal] = field(default_factory=dict)  # checked, by name
    events: Mapping[str, Event] = field(default_factory=dict)  # checked, by name
    # of real signals, and of payload fields as `event.field`
    units: Mapping[str, Unit] = field(default_factory=dict)
    # everything by name, macros and constants too
    declared: Mapping[str, Declared] = field(default_factory=dict)
    recursive: frozenset[str] = frozenset()  # macros and constants that are defined by themselves
    # words that an item with a syntax error may have declared
    doubtful: frozenset[str] = frozenset()

    def field(self, name: str) -> tuple[rv.FieldValue, Type] | None:
        """The payload field that `event.field` stands for, and its type."""
        event, _, last = name.rpartition(".")
        if event in self.events and last in self.events[event].fields:
            return rv.FieldValue(event, last), self.events[event].fields[last]
        return None


def close_name(table: Table, name: str, local: tuple[str, ...] = ()) -> str:
    """A proposal in place of an unknown name, in words; empty if no name is similar."""
    fields = [f"{e.name}.{f}" for e in table.events.values() for f in e.fields]
    if close := nearest(name, [*local, *table.declared, *fields]):
        return f"did you mean `{close}`?{_described(table, close)}"
    if event := table.events.get(name.rpartition(".")[0]):
        listed = ", ".join(f"`{field}`" for field in event.fields) or "none"
        return f"the fields of `{event.name}` are {listed}"
    return ""


def _described(table: Table, name: str) -> str:
    declared = table.declared.get(name)
    if declared is None:
        return ""
    role = getattr(declared, "role", None)
    parts = [declared.word, *([str(role)] if role else []), f"line {declared.name.span.line}"]
    return f"  ({', '.join(parts)})"


def close_unit(part: str) -> str:
    """A unit that is alike, or empty."""
    singular = part.lower().removesuffix("s")
    if singular in _LONG_NAMES:
        return _LONG_NAMES[singular]
    return nearest(part, unit_table())


class Operands(Protocol):
    """Evaluates operands; each method reports what is wrong in all of them before it raises."""

    table: Table

    def values(self, expressions: tuple[Expression, ...], scope: Scope) -> list[Value]:
        """The values of the operands."""

    def calculated(
        self, op: NumericOp, args: tuple[Expression, ...], scope: Scope, span: Span
    ) -> Value:
        """An operation on numbers, or on choices between them."""

    def formula(self, expression: Expression, scope: Scope) -> rv.Formula:
        """The formula that an operand stands for."""

    def duration(self, expression: Expression, scope: Scope) -> int:
        """The constant duration that an expression stands for, in ticks."""

    def known(self, name: str, scope: Scope) -> bool:
        """Whether a name stands for anything but a label."""

    def peeled(self, expression: Expression, scope: Scope) -> tuple[Expression, Scope]:
        """An operand without brackets and macro parameters around it."""
