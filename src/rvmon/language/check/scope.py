"""The values of expressions during the check, and the scopes and tables that resolve names."""

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
    integral: bool = False  # whether its type allows whole numbers only
    labels: tuple[str, ...] = ()  # the possible labels if it is a label
    truth: bool = False  # whether it is a bool, represented by 0 and 1
    lone: Lone | None = None  # the window, if the expression is just a window


def typed(node: rv.Numeric, type_: Type, unit: Unit) -> Quantity:
    """The quantity of an expression with a declared type."""
    return Quantity(
        node, unit=unit, integral=type_.kind is Kind.INT,
        labels=type_.labels, truth=type_.kind is Kind.BOOL,
    )  # fmt: skip


class Age(Struct, frozen=True):
    """`age(x)`: the time since the last update; may only be compared with a duration."""

    name: str


class Chosen(Struct, frozen=True):
    """`if φ then x else y` between numbers; a comparison with it is made for each side."""

    condition: rv.Formula
    chosen: Value
    otherwise: Value


class Now(Struct, frozen=True):
    """`now` or `now - t0`: a time that may only be compared; plain `now` may be captured too."""

    since: str | None = None  # the name of the captured instant; `None`: the first of the trace


class Moment(Struct, frozen=True):
    """A captured instant, or one `later` by a duration; may only be compared with `now`."""

    name: str
    later: Quantity | None = None


class Lone(Struct, frozen=True):
    """A number that is just a window; its comparison with a limit is exact (`Amount`)."""

    of: rv.WindowValue  # the window; for a share, the duration that is divided by D
    added: Quantity | None = None  # the x of a window over numbers
    share: bool = False  # whether it is a share, divided by D
    # the condition that the trigger has come, if only members since then count
    started: rv.Formula | None = None


TimeValue = Age | Now | Moment
"""Values of time, which are allowed only as a side of a comparison."""

Value = rv.Formula | Quantity | TimeValue | Chosen


class Closure(Struct, frozen=True):
    """A macro's argument: an expression with the scope in which it was written."""

    expression: Expression
    scope: Scope


class AtTrigger(Struct, frozen=True):
    """Collects the values that a consequent needs from its trigger, in addition to `let`."""

    captures: list[Capture] = field(default_factory=list)

    def started(self, span: Span) -> rv.Passed:
        """The condition that the trigger has come; captures its instant."""
        if not any(capture.name == rv.TRIGGERED for capture in self.captures):
            self.captures.append(Capture(rv.TRIGGERED, rv.NowValue()))
        return rv.since_trigger(span)

    def number(self, word: str, value: rv.Numeric) -> str:
        """Capture a number at the trigger; the result is its name, which starts with `word`.

        `word` is a keyword.
        """
        for capture in self.captures:
            if capture.value == value and capture.name.startswith(word):
                return capture.name
        # The name is a keyword or has a space, so that it cannot clash with the name of a `let`.
        taken = sum(capture.name.startswith(word) for capture in self.captures)
        self.captures.append(Capture(f"{word} {taken + 1}" if taken else word, value))
        return self.captures[-1].name


class Scope(Struct, frozen=True):
    """The local names of a macro or requirement, in addition to the names of the file."""

    # the meaning of each local name
    names: Mapping[str, Closure | Quantity | Moment] = field(default_factory=dict)
    trigger: AtTrigger | None = None  # in a consequent, collects the captures at its trigger
    at_once: bool = False  # whether the formula is evaluated at the trigger, not at a later instant

    def later(self) -> Scope:
        """The scope below a temporal operator."""
        return replace(self, at_once=False) if self.at_once else self

    def inside(self, names: Mapping[str, Closure]) -> Scope:
        """The scope of the body of a macro; `names` are its parameters."""
        return Scope(names, self.trigger, self.at_once)


EVERYWHERE = Scope()  # only the names of the file


_LONG_NAMES = {
    "metre": "m", "meter": "m", "millimetre": "mm", "millimeter": "mm", "second": "s", "sec": "s",
    "millisecond": "ms", "msec": "ms", "minute": "min", "hour": "h", "hr": "h", "gram": "g",
    "kilogram": "kg", "kilo": "kg", "newton": "N", "radian": "rad", "degree": "deg", "°": "deg",
    "turn": "rev", "celsiu": "degC", "kelvin": "K", "volt": "V", "amp": "ampere", "hertz": "Hz",
    "percent": "%", "mp": "m/s", "kmh": "km/h", "kph": "km/h", "pixel": "px", "byte": "B",
}  # fmt: skip
"""The symbols of units by what people write instead, in lower case and without a final `s`."""


class Table(Struct, frozen=True):
    """The declarations of a file, by name."""

    time: TimeModel
    signals: Mapping[str, Signal] = field(default_factory=dict)  # checked, by name
    events: Mapping[str, Event] = field(default_factory=dict)  # checked, by name
    # of real signals, and of payload fields as `event.field`
    units: Mapping[str, Unit] = field(default_factory=dict)
    # all declarations by name, with macros and constants
    declared: Mapping[str, Declared] = field(default_factory=dict)
    recursive: frozenset[str] = frozenset()  # macros and constants that lead into a cycle
    # words that an item with a syntax error may have declared
    doubtful: frozenset[str] = frozenset()

    def field(self, name: str) -> tuple[rv.FieldValue, Type] | None:
        """The payload field that `event.field` stands for, and its type."""
        event, _, last = name.rpartition(".")
        if event in self.events and last in self.events[event].fields:
            return rv.FieldValue(event, last), self.events[event].fields[last]
        return None


def close_name(table: Table, name: str, local: tuple[str, ...] = ()) -> str:
    """A suggestion for an unknown name, in words; empty if no name is similar."""
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
    """A similar unit, or empty."""
    singular = part.lower().removesuffix("s")
    if singular in _LONG_NAMES:
        return _LONG_NAMES[singular]
    return nearest(part, unit_table())


class Operands(Protocol):
    """Evaluates operands; each method reports the errors of all operands before it raises."""

    table: Table

    def values(self, expressions: tuple[Expression, ...], scope: Scope) -> list[Value]:
        """The values of the operands."""

    def calculated(
        self, op: NumericOp, args: tuple[Expression, ...], scope: Scope, span: Span
    ) -> Value:
        """The result of an operation on numbers, or on choices between numbers."""

    def formula(self, expression: Expression, scope: Scope) -> rv.Formula:
        """The formula that an operand stands for."""

    def duration(self, expression: Expression, scope: Scope) -> int:
        """The constant duration that an expression stands for, in ticks."""

    def known(self, name: str, scope: Scope) -> bool:
        """Whether a name stands for anything but a label."""

    def unwrapped(self, expression: Expression, scope: Scope) -> tuple[Expression, Scope]:
        """An operand without brackets, with macro parameters replaced by their arguments."""
