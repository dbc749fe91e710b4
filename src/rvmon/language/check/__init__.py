"""From resolved names to the checked specification: types, units, durations, requirements."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TypeVar

from msgspec.structs import replace

from rvmon.diagnostics import Span
from rvmon.language.check.coverage import checked_cover, checked_coverpoint, checked_cross
from rvmon.language.check.ctl import checked_goal, checked_property
from rvmon.language.check.expressions import Checker
from rvmon.language.check.requirements import check_clauses, checked_requirement
from rvmon.language.check.scope import EVERYWHERE, Table, close_name, close_unit
from rvmon.language.checked import specification
from rvmon.language.checked.properties import Cover
from rvmon.language.names import ResolvedSpec, find_cycles
from rvmon.language.rules import Findings
from rvmon.language.rules import names as name_rules
from rvmon.language.rules import types as type_rules
from rvmon.language.syntax import items
from rvmon.language.syntax.expressions import Expression, Name
from rvmon.trace.schema import Kind
from rvmon.units import Unit, UnknownUnitError, parse_unit

S = TypeVar("S")
T = TypeVar("T")


def check(spec: ResolvedSpec, findings: Findings) -> specification.CheckedSpec:
    """Check all items of a specification; the result is valid only if no finding is an error."""
    recursive = find_cycles(spec.declared, findings)
    table = _table(spec, recursive, findings)
    checker = Checker(table, findings, sum(len(source.text) for source in spec.sources))
    signals = dict(table.signals)
    for declared in spec.declared.values():
        if isinstance(declared, items.SignalSyntax) and declared.stale_after is not None:
            name = declared.name.text
            if name in signals:
                what = "the age at which a signal is stale"
                ticks = _positive(checker, declared.stale_after, what)
                signals[name] = replace(signals[name], stale_after=ticks)
    period = delay = None
    if spec.time is not None and spec.time.period is not None:
        period = _positive(checker, spec.time.period, "the period")
    if spec.delay is not None:
        delay = checker.collected(checker.duration, spec.delay.delay, EVERYWHERE)
    requirements: dict[str, specification.Requirement] = {}
    goals: dict[str, Cover] = {}
    for name, item in spec.requirements.items():
        check_clauses(checker, item)
        if isinstance(item.body, items.CoverMonitor):
            goal = checker.collected(checked_goal, checker, item, item.body.span)
            goals.update({} if goal is None else {name: goal})
            continue
        requirement = checker.collected(checked_requirement, checker, item)
        if requirement is not None:
            requirements[name] = requirement
    # A macro is checked where it is used, so errors in unused macros are still to be found.
    check_unused(checker, spec)
    stated: list[specification.Requirement | Cover] = [*requirements.values(), *goals.values()]
    properties = {part.id: part.ctl for part in stated if part.ctl is not None}
    for name, alone in spec.properties.items():
        if property_ := checked_property(checker, name, alone.formula):
            properties[name] = property_
    covers = _right(partial(checked_cover, checker), spec.covers) | goals
    points = _right(partial(checked_coverpoint, checker), spec.coverpoints)
    about = points, spec.coverpoints
    crosses = _right(lambda s: checker.collected(checked_cross, checker, s, *about), spec.crosses)
    named = (spec.header.name.text, spec.header.title) if spec.header else ("spec", "")
    return specification.CheckedSpec(
        *named, table.time, signals, table.events, requirements, period, delay, spec.sources[0],
        properties, covers, points, crosses,
    )  # fmt: skip


def _right(make: Callable[[S], T | None], written: Mapping[str, S]) -> dict[str, T]:
    """The results of `make` by name, without those that are `None`."""
    return {name: made for name, syntax in written.items() if (made := make(syntax)) is not None}


def _table(spec: ResolvedSpec, recursive: frozenset[str], findings: Findings) -> Table:
    signals: dict[str, specification.Signal] = {}
    events: dict[str, specification.Event] = {}
    units: dict[str, Unit] = {}
    for name, declared in spec.declared.items():
        match declared:
            case items.SignalSyntax():
                type_and_unit = _type(declared.type, findings)
                if type_and_unit is not None:
                    type_, units[name] = type_and_unit
                    if declared.ignored is not None and type_.kind is not Kind.REAL:
                        findings.add(type_rules.ignored_nan(declared.ignored, str(type_.kind)))
                    signals[name] = specification.Signal(
                        name, type_, declared.role, ignores_nan=declared.ignored is not None,
                        span=declared.name.span,
                    )  # fmt: skip
            case items.EventSyntax():
                fields = {}
                for field in declared.fields:
                    # A signal may have a dotted name, so `pick.id` could be both a signal and a
                    # field of `pick`.
                    taken = spec.declared.get(f"{name}.{field.name.text}")
                    first = declared if field.name.text in fields else taken
                    if first is not None:
                        places = field.name.span, first.name.span
                        findings.add(name_rules.double(field.name.text, "field", *places))
                    type_and_unit = _type(field.type, findings)
                    if type_and_unit is not None:
                        fields[field.name.text], units[f"{name}.{field.name.text}"] = type_and_unit
                events[name] = specification.Event(name, fields, declared.role, declared.name.span)
    time = spec.time.model if spec.time is not None else specification.TimeModel.HELD
    return Table(time, signals, events, units, spec.declared, recursive, spec.doubtful)


def _type(syntax: items.TypeSyntax, findings: Findings) -> tuple[specification.Type, Unit] | None:
    """A type with its unit; `None`, with a finding, if the unit does not exist."""
    labels = tuple(label.text for label in syntax.labels)
    firsts: dict[str, Span] = {}
    for label in syntax.labels:
        first = firsts.setdefault(label.text, label.span)
        if first is not label.span:
            findings.add(name_rules.double(label.text, "label", label.span, first))
    try:
        unit = parse_unit(syntax.unit)
    except UnknownUnitError as error:
        findings.add(type_rules.unknown_unit(syntax.span, str(error), close_unit(str(error))))
        return None
    return specification.Type(Kind(syntax.name), syntax.unit, labels), unit


def _positive(checker: Checker, expression: Expression, what: str) -> int | None:
    ticks = checker.collected(checker.duration, expression, EVERYWHERE)
    if ticks == 0:
        checker.report(type_rules.not_positive(expression.span, what))
    return ticks


def check_unused(checker: Checker, spec: ResolvedSpec) -> None:
    """Report errors in macros and constants; in macros with parameters, undeclared names only."""
    for item in spec.declared.values():
        match item:
            case items.DefineItem(parameters=None, name=name) | items.ConstItem(name=name):
                checker.value(Name(name.text, name.span), EVERYWHERE)
            case items.DefineItem(parameters=parameters):
                named = tuple(parameter.text for parameter in parameters or ())
                for part in checker.undeclared(item.body):
                    if part.text not in named:
                        close = close_name(checker.table, part.text, named)
                        checker.report(name_rules.unknown(part.span, part.text, close))
