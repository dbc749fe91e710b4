"""A checked specification: names, types and units are resolved. Monitors are made from it.

Bare formulas are split into trigger and consequent (SEMANTICS 3).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum

from msgspec import Struct, field

from rvmon.diagnostics import Source, Span
from rvmon.language.checked.formula import (
    Captured,
    FieldValue,
    Formula,
    Literal,
    Numeric,
    SignalValue,
    UpdateFunction,
    UpdateValue,
)
from rvmon.language.checked.properties import Cover, Coverpoint, Cross, Property
from rvmon.trace.schema import Kind, Schema


class Role(StrEnum):
    """The side that sets a signal or event: the environment (`input`) or the system (`output`)."""

    INPUT = "input"
    OUTPUT = "output"


class Type(Struct, frozen=True):
    """The type of a signal or field: reals have the `unit` as written ("" for none)."""

    kind: Kind
    unit: str = ""
    labels: tuple[str, ...] = ()


class Signal(Struct, frozen=True):
    """A declared signal."""

    name: str
    type: Type
    role: Role | None = None
    stale_after: int | None = None  # ticks after which a value without an update is unknown
    # whether NaN and null are ignored as updates; otherwise they make the value unknown
    ignores_nan: bool = False
    span: Span | None = None  # the place of its declaration


class Event(Struct, frozen=True):
    """A declared event with the types of its payload's fields."""

    name: str
    fields: Mapping[str, Type] = field(default_factory=dict)
    role: Role | None = None
    span: Span | None = None


class Mode(StrEnum):
    """How attempts start, and over which positions the consequent is required (SEMANTICS 3)."""

    UPON = "upon"
    WHENEVER = "whenever"


class EndPolicy(StrEnum):
    """The verdict of an undecided attempt at the end of the trace (SEMANTICS 3, The end)."""

    DEFAULT = "default"
    STRICT = "strict"
    WEAK = "weak"
    STRONG = "strong"
    PASS = "pass"
    FAIL = "fail"


class Capture(Struct, frozen=True):
    """`let name = expression`."""

    name: str
    value: Numeric


class ForEach(Struct, frozen=True):
    """`for each name in event.field`: one instance of the requirement per value."""

    name: str
    value: FieldValue


class RunShare(Struct, frozen=True):
    """`in at least 95 % of runs`: a campaign decides by the share of runs.

    Single runs are judged as without the clause.
    """

    at_least: bool  # whether the share is a lower bound; otherwise it is an upper bound
    percent: float  # above 0, below 100

    def __str__(self) -> str:
        """The clause as it is written."""
        return f"in at {'least' if self.at_least else 'most'} {self.percent:.15g} % of runs"


@dataclass(frozen=True, slots=True)
class Requirement:
    """A requirement, split into trigger and consequent.

    Attributes:
        id: unique in the spec.
        mode: `upon` or `whenever`.
        trigger: a formula of the present and past; `BoundAtom(END)` stands only alone.
        consequent: the required formula.
        text: the requirement in words.
        at_end: policy for undecided attempts.
        pulse: whether the trigger is a pulse (SEMANTICS 3): it starts an attempt wherever it holds.
        captures: the values captured at the trigger, by `let` and by the checker.
        for_each: the `for each` clause, if there is one.
        ctl: the CTL property of the requirement, if it has one.
        scope: the `scope` clause as written; trigger and consequent already include it.
        run_share: the share of runs in which it must hold; `None`: in every run.
        span: the place of the whole item.
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
    span: Span | None = None
    ctl: Property | None = None
    scope: str = ""
    run_share: RunShare | None = None

    @property
    def captured(self) -> Mapping[str, Numeric]:
        """The values that each attempt has of its own, by name: `for each`, then `captures`."""
        each = {} if self.for_each is None else {self.for_each.name: self.for_each.value}
        return each | {capture.name: capture.value for capture in self.captures}


class TimeModel(StrEnum):
    """The time models, which define what instants are positions (SEMANTICS 1)."""

    HELD = "held"
    SAMPLED = "sampled"
    CLOCKED = "sampled every"


class CheckedSpec(Struct, frozen=True):
    """A whole specification, ready for lowering."""

    name: str
    title: str
    time: TimeModel
    signals: Mapping[str, Signal]
    events: Mapping[str, Event]
    requirements: Mapping[str, Requirement]
    period: int | None = None  # the D of `sampled every D`, ticks; `None` in the other time models
    max_delay: int | None = None  # the D of `max delay D`, ticks
    source: Source | None = None  # the text of the main file
    # the CTL properties by id, those of requirements and those that are items of their own
    properties: Mapping[str, Property] = field(default_factory=dict)
    covers: Mapping[str, Cover] = field(default_factory=dict)  # the cover goals by id
    coverpoints: Mapping[str, Coverpoint] = field(default_factory=dict)  # by name
    crosses: Mapping[str, Cross] = field(default_factory=dict)  # by name

    @property
    def gap(self) -> int | None:
        """Ticks between two positions; `None` if only samples are positions."""
        return {TimeModel.HELD: 1, TimeModel.SAMPLED: None}.get(self.time, self.period)

    @property
    def ignoring(self) -> frozenset[str]:
        """The signals with `ignore NaN`."""
        return frozenset(name for name, signal in self.signals.items() if signal.ignores_nan)

    @property
    def schema(self) -> Schema:
        """The declared names with kinds and units."""
        return Schema(
            {name: signal.type.kind for name, signal in self.signals.items()},
            {
                name: {field: type_.kind for field, type_ in event.fields.items()}
                for name, event in self.events.items()
            },
            self.ignoring,
            units={name: type_.unit for name, type_ in self._types() if type_.unit},
        )

    def kind_of(self, value: Numeric, requirement: Requirement) -> Kind | None:
        """The kind of a value that a requirement reads; `None` for a calculated number."""
        match value:
            case SignalValue(name=name) | UpdateValue(function=UpdateFunction.PREV, name=name):
                return self.signals[name].type.kind
            case FieldValue(event=event, field=field):
                return self.events[event].fields[field].kind
            case Captured(name=name):
                return self.kind_of(requirement.captured[name], requirement)
            case Literal(value=str()):
                return Kind.LABEL
            case _:
                return None

    def _types(self) -> Iterator[tuple[str, Type]]:
        """The type of each signal, and of each event's field as `event.field`."""
        for name, signal in self.signals.items():
            yield name, signal.type
        for name, event in self.events.items():
            yield from ((f"{name}.{field}", type_) for field, type_ in event.fields.items())
