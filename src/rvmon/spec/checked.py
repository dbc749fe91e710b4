"""A specification whose names, types and units are settled: what all engines start from.

Macros and constants are expanded, durations are ticks, intervals are closed, bare formulas are
split into trigger and consequent (SEMANTICS 3). `age(x) > D` and its kin are rewritten with
`updated(x)` and past operators. Operators are otherwise as written; their meaning is SEMANTICS 2.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

from rvmon.diagnostics.span import Source, Span
from rvmon.spec.arithmetic import NumericOp
from rvmon.trace.schema import Kind

if TYPE_CHECKING:
    from rvmon.spec.ctl import Property
    from rvmon.spec.goals import Cover, Coverpoint, Cross


@dataclass(frozen=True, slots=True)
class Interval:
    """The closed interval `[low, high]` of durations in ticks; `high` is `None` if unbounded."""

    low: int = 0
    high: int | None = None


class Role(StrEnum):
    """Who sets a signal or event: the environment (`input`) or the system (`output`)."""

    INPUT = "input"
    OUTPUT = "output"


@dataclass(frozen=True, slots=True)
class Type:
    """The type of a signal or field: `unit` as written for reals ("" if none), labels in order."""

    kind: Kind
    unit: str = ""
    labels: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Signal:
    """A declared signal.

    Attributes:
        name: of the signal.
        type: of its values.
        role: who sets it.
        stale_after: it is unknown so many ticks after its last update.
        ignores_nan: whether NaN and null are no update of it, instead of an unknown value.
        span: where its name is declared.
    """

    name: str
    type: Type
    role: Role | None = None
    stale_after: int | None = None
    ignores_nan: bool = False
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Event:
    """A declared event with the types of its payload's fields."""

    name: str
    fields: Mapping[str, Type] = field(default_factory=dict)
    role: Role | None = None
    span: Span | None = None


# Numeric (and label) expressions, evaluated in Python floats, ints or strings.


@dataclass(frozen=True, slots=True)
class Literal:
    """A number in the unit that the comparison is made in, or a label.

    Attributes:
        value: the number or label.
        unit: that unit's symbol, for people; "" if it has none.
    """

    value: float | int | str
    unit: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class SignalValue:
    """The held value of an int, real or label signal (bool: False is 0, True is 1)."""

    name: str


@dataclass(frozen=True, slots=True)
class FieldValue:
    """A payload field of an event; only meaningful where the event occurs."""

    event: str
    field: str


@dataclass(frozen=True, slots=True)
class Captured:
    """A value captured by `let` at the trigger, or the instance value of `for each`."""

    name: str


class UpdateFunction(StrEnum):
    """Functions of a signal's last two updates (SEMANTICS 2)."""

    PREV = "prev"
    DELTA = "delta"
    RATE = "rate"


@dataclass(frozen=True, slots=True)
class UpdateValue:
    """`prev(x)`, `delta(x)` or `rate(x)` (per second); unknown before the second update."""

    function: UpdateFunction
    name: str


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """An operation on numbers; a result that is no number (0/0, sqrt(-1), overflow) is unknown."""

    op: NumericOp
    args: tuple[Numeric, ...]


Numeric = Literal | SignalValue | FieldValue | Captured | UpdateValue | Arithmetic


# Formulas.


class CompareOp(StrEnum):
    """Comparisons of numbers; labels know only `==` and `!=`."""

    LT = "<"
    LE = "<="
    EQ = "=="
    NE = "!="
    GE = ">="
    GT = ">"


@dataclass(frozen=True, slots=True)
class Constant:
    """`true` or `false`."""

    value: bool
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class SignalAtom:
    """A bool signal as a proposition."""

    name: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class EventAtom:
    """An event: true at the ticks at which it was published."""

    name: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Compare:
    """A comparison; one that reads fields of an event `e` means `e and comparison`."""

    op: CompareOp
    left: Numeric
    right: Numeric
    span: Span | None = None


class Probe(StrEnum):
    """Propositions about the updates of a signal (or event, for `updated`)."""

    KNOWN = "known"
    UPDATED = "updated"
    CHANGED = "changed"


@dataclass(frozen=True, slots=True)
class ProbeAtom:
    """`known(x)`, `updated(x)` (two-valued) or `changed(x)` (an update with another value)."""

    probe: Probe
    name: str
    span: Span | None = None


class Bound(StrEnum):
    """The two ends of a trace as propositions; `end` stands only alone, as a trigger."""

    START = "start"
    END = "end"


@dataclass(frozen=True, slots=True)
class BoundAtom:
    """`start` is true at the first position; `end` when the trace is finished."""

    bound: Bound
    span: Span | None = None


class UnaryOp(StrEnum):
    """Unary operators; those of time but `X Y rise fall` carry an interval (`held` is [0, D])."""

    NOT = "!"
    NEXT = "X"
    EVENTUALLY = "F"
    ALWAYS = "G"
    PREVIOUS = "Y"
    ONCE = "O"
    HISTORICALLY = "H"
    RISE = "rise"
    FALL = "fall"
    HELD = "held"


class BinaryOp(StrEnum):
    """Binary operators; those of time carry an interval."""

    AND = "and"
    OR = "or"
    IMPLIES = "->"
    IFF = "<->"
    XOR = "xor"
    UNTIL = "U"
    RELEASE = "R"
    WEAK_UNTIL = "W"
    STRONG_RELEASE = "M"
    SINCE = "S"


@dataclass(frozen=True, slots=True)
class Unary:
    """An operator on one formula; `interval` is `None` exactly where the operator has none."""

    op: UnaryOp
    operand: Formula
    interval: Interval | None = None
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Binary:
    """An operator on two formulas; `interval` is `None` exactly where the operator has none."""

    op: BinaryOp
    left: Formula
    right: Formula
    interval: Interval | None = None
    span: Span | None = None


Atom = Constant | SignalAtom | EventAtom | Compare | ProbeAtom | BoundAtom
Formula = Atom | Unary | Binary


# Requirements.


class Mode(StrEnum):
    """How attempts start and what they owe (SEMANTICS 3)."""

    UPON = "upon"
    WHENEVER = "whenever"


class EndPolicy(StrEnum):
    """What becomes of an undecided attempt when the trace ends (SEMANTICS 3, The end)."""

    DEFAULT = "default"
    STRICT = "strict"
    WEAK = "weak"
    STRONG = "strong"
    PASS = "pass"
    FAIL = "fail"


@dataclass(frozen=True, slots=True)
class Capture:
    """`let name = expression`."""

    name: str
    value: Numeric


@dataclass(frozen=True, slots=True)
class ForEach:
    """`for each name in event.field`: one instance of the requirement per value."""

    name: str
    value: FieldValue


@dataclass(frozen=True, slots=True)
class Requirement:
    """A requirement, split into trigger and consequent.

    Attributes:
        id: unique in the spec.
        mode: `upon` or `whenever`.
        trigger: present and past only; `BoundAtom(END)` only alone.
        consequent: what is owed.
        text: the requirement in words.
        at_end: policy for undecided attempts.
        pulse: whether the trigger is a pulse (SEMANTICS 3): it starts an attempt wherever it holds.
        property: the CTL property's text, if it has one.
        ctl: the same, checked.
        scope: the `scope` clause as written; trigger and consequent have it worked in.
        span: of the whole item.
    """

    id: str
    mode: Mode
    trigger: Formula
    consequent: Formula
    text: str = ""
    at_end: EndPolicy = EndPolicy.DEFAULT
    pulse: bool = False
    captures: tuple[Capture, ...] = ()
    for_each: ForEach | None = None
    source: str = ""
    rationale: str = ""
    severity: str = ""
    tags: tuple[str, ...] = ()
    property: str = ""
    span: Span | None = None
    ctl: Property | None = None
    scope: str = ""


class TimeModel(StrEnum):
    """Which instants are positions (SEMANTICS 1)."""

    HELD = "held"
    SAMPLED = "sampled"
    CLOCKED = "sampled every"


@dataclass(frozen=True, slots=True)
class CheckedSpec:
    """A whole specification, ready for lowering.

    Attributes:
        period: the D of `sampled every D`, ticks; `None` in the other time models.
        max_delay: the watermark of `max delay D`, ticks.
        source: the text it came from.
        properties: the CTL properties, of requirements (under their id) and alone.
        covers: the cover goals by id.
        coverpoints: by name.
        crosses: by name.
    """

    name: str
    title: str
    time: TimeModel
    signals: Mapping[str, Signal]
    events: Mapping[str, Event]
    requirements: Mapping[str, Requirement]
    period: int | None = None
    max_delay: int | None = None
    source: Source | None = None
    properties: Mapping[str, Property] = field(default_factory=dict)
    covers: Mapping[str, Cover] = field(default_factory=dict)
    coverpoints: Mapping[str, Coverpoint] = field(default_factory=dict)
    crosses: Mapping[str, Cross] = field(default_factory=dict)

    @property
    def ignoring(self) -> frozenset[str]:
        """The signals of which NaN and null are no update."""
        return frozenset(name for name, signal in self.signals.items() if signal.ignores_nan)
