"""The names of a file with their checked types, and how a name is looked up and missed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from rvmon.diagnostics.nearest import nearest
from rvmon.spec.check.values import FieldOf
from rvmon.spec.checked.specification import Event, Signal, TimeModel
from rvmon.spec.names.resolved import Declared, DeclaredEvent, DeclaredSignal
from rvmon.spec.syntax.items import ConstItem, DefineItem
from rvmon.units import Unit, unit_table

_LONG_NAMES = {
    "metre": "m",
    "meter": "m",
    "millimetre": "mm",
    "millimeter": "mm",
    "second": "s",
    "sec": "s",
    "millisecond": "ms",
    "msec": "ms",
    "minute": "min",
    "hour": "h",
    "hr": "h",
    "gram": "g",
    "kilogram": "kg",
    "kilo": "kg",
    "newton": "N",
    "radian": "rad",
    "degree": "deg",
    "°": "deg",
    "turn": "rev",
    "celsiu": "degC",
    "kelvin": "K",
    "volt": "V",
    "amp": "ampere",
    "hertz": "Hz",
    "percent": "%",
    "mp": "m/s",
    "kmh": "km/h",
    "kph": "km/h",
    "pixel": "px",
    "byte": "B",
}
"""What people write for a unit, in lower case and without a last `s`."""


@dataclass(frozen=True, slots=True)
class Table:
    """What the names of a file stand for.

    Attributes:
        time: the time model.
        signals: checked, by name.
        events: checked, by name.
        units: of real signals, and of payload fields as `event.field`.
        declared: everything by name, macros and constants too.
        recursive: macros and constants that are defined by themselves.
        doubtful: words that an item with a syntax error may have declared.
    """

    time: TimeModel
    signals: Mapping[str, Signal] = field(default_factory=dict)
    events: Mapping[str, Event] = field(default_factory=dict)
    units: Mapping[str, Unit] = field(default_factory=dict)
    declared: Mapping[str, Declared] = field(default_factory=dict)
    recursive: frozenset[str] = frozenset()
    doubtful: frozenset[str] = frozenset()

    def field(self, name: str) -> FieldOf | None:
        """The payload field that `event.field` stands for."""
        event, _, last = name.rpartition(".")
        if event in self.events and last in self.events[event].fields:
            return FieldOf(event, last, self.events[event].fields[last])
        return None


def close_name(table: Table, name: str, local: tuple[str, ...] = ()) -> str:
    """What to try in place of an unknown name, in words; empty if nothing is alike."""
    fields = [f"{e.name}.{f}" for e in table.events.values() for f in e.fields]
    close = nearest(name, [*local, *table.declared, *fields])
    return f"did you mean `{close}`?{_described(table, close)}" if close else ""


def _described(table: Table, name: str) -> str:
    declared = table.declared.get(name)
    match declared:
        case DeclaredSignal(role=role) | DeclaredEvent(role=role):
            kind = "event" if isinstance(declared, DeclaredEvent) else "signal"
            parts = [kind, *([str(role)] if role else []), f"line {declared.name.span.line}"]
        case DefineItem() | ConstItem():
            kind = "define" if isinstance(declared, DefineItem) else "const"
            parts = [kind, f"line {declared.name.span.line}"]
        case None:
            return ""
    return f"  ({', '.join(parts)})"


def close_unit(part: str) -> str:
    """A unit that is alike, or empty."""
    singular = part.lower().removesuffix("s")
    if singular in _LONG_NAMES:
        return _LONG_NAMES[singular]
    return nearest(part, unit_table())
