"""Functions and updates as the text of UPPAAL's language."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import assert_never

from rvmon.export.names import Names, Thing
from rvmon.timed.model.expressions import (
    Assignment,
    Function,
    If,
    Missing,
    Perform,
    Reset,
    Return,
    Statement,
    Variable,
    VariableValue,
    While,
    expressions_of,
    statements_in,
)
from rvmon.timed.model.guards import parts_of


def updates_text(names: Names, updates: Iterable[Statement]) -> str:
    """The updates of an edge in their order."""
    return ", ".join(line.removesuffix(";") for line in _lines(names, updates))


def function_lines(names: Names) -> list[str]:
    """All functions that were named so far, those that others call first."""
    return [line for _, function in names.functions.values() for line in _function(names, function)]


def type_text(variable: Variable) -> str:
    """The type of a variable."""
    return "bool" if variable.is_bool else f"int[{variable.low},{variable.high}]"


def _function(names: Names, function: Function) -> Iterator[str]:
    given = [(f"given_{i}", slot, v) for i, (slot, v) in enumerate(function.parameters)]
    listed = ", ".join(f"{type_text(variable)} {name}" for name, _, variable in given)
    yield f"{type_text(function.result[1])} {names.function(function)}({listed}) {{"
    for thing in _locals(names, function):
        yield f"  {type_text(names.network.locals[thing.first])} {thing.declarator};"
    count = len(names.network.locals)
    for name, slot, _ in given:
        thing = next(t for t in names.locals if t.first <= slot + count < t.first + t.length)
        yield f"  {thing.element(slot + count)} = {name};"
    for line in _lines(names, function.body):
        yield f"  {line}"
    yield "}"


def _locals(names: Names, function: Function) -> list[Thing]:
    """The parameters and local variables of a function, arrays as one thing."""
    slots = {slot for slot, _ in function.parameters}
    for statement in statements_in(function.body):
        if isinstance(statement, Assignment):
            slots.add(statement.slot.first)
        for part in (p for e in expressions_of(statement) for p in parts_of(e)):
            if isinstance(part, VariableValue):
                slots.add(part.slot.first)
    places = {slot + len(names.network.locals) for slot in slots if slot < 0}
    return [t for t in names.locals if places & set(range(t.first, t.first + t.length))]


def _lines(names: Names, statements: Iterable[Statement]) -> Iterator[str]:
    for statement in statements:
        yield from _statement(names, statement)


def _statement(names: Names, statement: Statement) -> Iterator[str]:
    text = names.expression
    match statement:
        case Assignment(slot, value):
            yield f"{names.variable(slot)} = {text(value)};"
        case Reset(clock, value):
            yield f"{names.clock(clock)} = {text(value)};"
        case Perform(call):
            yield f"{text(call)};"
        case If(condition, then, otherwise):
            yield from _nested(names, f"if ({text(condition)}) {{", then)
            if otherwise:
                yield from _nested(names, "else {", otherwise)
        case While(condition, body):
            yield from _nested(names, f"while ({text(condition)}) {{", body)
        case Return(value):
            yield f"return {text(value)};"
        case Missing():
            pass
        case _:
            assert_never(statement)


def _nested(names: Names, head: str, inside: Sequence[Statement]) -> Iterator[str]:
    yield head
    for line in _lines(names, inside):
        yield f"  {line}"
    yield "}"
