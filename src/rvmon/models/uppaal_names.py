"""Names, expressions and functions of a network in the syntax of UPPAAL and similar tools."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from math import prod
from typing import assert_never

from rvmon.models.network import Network
from rvmon.models.network import expressions as ex
from rvmon.models.network.fractions import FUNCTIONS, number_of
from rvmon.models.network.guards import parts_in

_KEYWORDS = (
    "after_update and assign before_update bool break broadcast case chan clock "
    "commit const continue deadlock default do double else exists false for forall "
    "guard hybrid if imply init int meta not or priority process progress rate return "
    "scalar select state struct switch sync system trans true typedef urgent void "
    "while"
)
_RESERVED = frozenset(_KEYWORDS.split())
_INDICES = re.compile(r"\[(-?\d+)\]")
_SIGNS = {ex.BinaryOp.AND: "&&", ex.BinaryOp.OR: "||"}


@dataclass(frozen=True, slots=True)
class Thing:
    """A clock, variable or channel, or an array of these, under its new name."""

    name: str
    first: int  # index of the first element in the network
    # the index range of each dimension in the network; in the text indices start at 0
    extents: tuple[range, ...]

    @property
    def length(self) -> int:
        """The number of elements."""
        return prod(map(len, self.extents))

    @property
    def declarator(self) -> str:
        """The name, followed by the sizes of an array."""
        return self.name + "".join(f"[{len(extent)}]" for extent in self.extents)

    def element(self, index: int) -> str:
        """The text for one element."""
        rest, places = index - self.first, ""
        for extent in reversed(self.extents):
            rest, place = divmod(rest, len(extent))
            places = f"[{place}]{places}"
        return self.name + places


class Names:
    """The new names of everything in a network. Local names become global."""

    def __init__(self, network: Network) -> None:
        self._taken: set[str] = set(_RESERVED)
        self.network = network
        # in order, each array as one thing; `locals` are local variables of functions
        self.clocks = self._things([clock.name for clock in network.clocks])
        self.variables = self._things([variable.name for variable in network.variables])
        self.channels = self._things([channel.name for channel in network.channels])
        self.locals = self._things([variable.name for variable in network.locals])
        # the functions named so far, callees first
        self.functions: dict[int, tuple[str, ex.Function]] = {}
        self.automata = [self._fresh(automaton.name) for automaton in network.automata]

    def _fresh(self, name: str) -> str:
        base = re.sub(r"\W+", "_", name).strip("_") or "x"
        base = f"_{base}" if base[0].isdigit() else base
        fresh, number = base, 1
        while fresh in self._taken:
            number += 1
            fresh = f"{base}_{number}"
        self._taken.add(fresh)
        return fresh

    def _things(self, names: Sequence[str]) -> list[Thing]:
        things = []
        numbered = enumerate(names)
        for base, members in groupby(numbered, key=lambda item: _INDICES.sub("", item[1])):
            alike: dict[tuple[int, ...], int] = {}
            for index, name in members:
                place = tuple(map(int, _INDICES.findall(name)))
                if place in alike:  # adjacent locals of different functions may share a name
                    things.append(self._thing(base, alike))
                    alike = {}
                alike[place] = index
            things.append(self._thing(base, alike))
        return things

    def _thing(self, base: str, indices: Mapping[tuple[int, ...], int]) -> Thing:
        dimensions = zip(*indices, strict=True)
        extents = tuple(range(min(places), max(places) + 1) for places in dimensions)
        return Thing(self._fresh(base), min(indices.values()), extents)

    def function(self, function: ex.Function) -> str:
        """The name of a function. The functions that it calls are named first."""
        if id(function) not in self.functions:
            for part in parts_in(function.body):
                if isinstance(part, ex.Invoke):
                    self.function(part.function)
            self.functions[id(function)] = self._fresh(function.name), function
        return self.functions[id(function)][0]

    def location(self, automaton: int, place: int) -> str:
        """The name of a location, unique in its automaton."""
        names = [location.name for location in self.network.automata[automaton].locations]
        name = re.sub(r"\W+", "_", names[place]) or f"location_{place}"
        return f"{name}_" if name in _RESERVED else name

    def clock(self, index: int) -> str:
        """The text for a clock."""
        return _holder(self.clocks, index).element(index)

    def variable(self, slot: ex.Slot) -> str:
        """The text for a variable, global or local; its indices may be expressions."""
        if slot.first >= 0:
            return self.slot(slot, self.variables)
        first = slot.first + len(self.network.locals)
        return self.slot(replace(slot, first=first), self.locals)

    def slot(self, slot: ex.Slot, things: Iterable[Thing]) -> str:
        """The text for one of `things`; its indices may be expressions."""
        thing = _holder(things, slot.first)
        if not slot.extents:
            return thing.element(slot.first)
        places = []
        for extent, index in zip(slot.extents, slot.indices, strict=True):
            text = self.expression(index)
            places.append(f"[{text} - {extent.start}]" if extent.start else f"[{text}]")
        return thing.name + "".join(places)

    def expression(self, expression: ex.Expression) -> str:
        """An expression, with operands in brackets where needed."""
        match expression:
            case ex.Constant(value):
                return str(value) if value >= 0 else f"({value})"
            case ex.VariableValue(slot):
                return self.variable(slot)
            case ex.Lookup(values, slot):
                return _chosen(values, slot.extents, [self.expression(i) for i in slot.indices])
            case ex.Invoke(function, arguments):
                given = ", ".join(map(self.expression, arguments))
                return f"{self.function(function)}({given})"
            case ex.Fractional("=", (ex.Constant(bits),)):
                text = repr(number_of(bits))
                return text if bits >= 0 else f"({text})"
            case ex.Fractional("=" | "double" | "grid", (operand,)):
                return self.expression(operand)
            case ex.Fractional(name, operands):
                texts = [*map(self.expression, operands)]
                call = f"{name}({', '.join(texts)})"
                return call if name in FUNCTIONS else f"({texts[0]} {name} {texts[1]})"
            case ex.UnaryOperation(ex.UnaryOp.NOT, operand):
                return f"!({self.expression(operand)})"
            case ex.UnaryOperation(op, operand):
                return f"({op}{self.expression(operand)})"
            case ex.BinaryOperation(op, left, right):
                sign = _SIGNS.get(op, str(op))
                return f"({self.expression(left)} {sign} {self.expression(right)})"
            case ex.Choice(condition, then, otherwise):
                parts = map(self.expression, (condition, then, otherwise))
                return "({} ? {} : {})".format(*parts)
            case ex.InLocation(automaton, place):
                return f"{self.automata[automaton]}.{self.location(automaton, place)}"
            case ex.ClockCompare(clock, op, bound):
                return f"{self.clock(clock)} {op} {self.expression(bound)}"
            case ex.Deadlock():
                return "deadlock"
            case ex.PathFormula(op, body, bound):
                limit = "" if bound is None else f"[<={bound}]"
                return f"{op}{limit} {self.expression(body)}"
            case _:
                assert_never(expression)


def _chosen(values: Sequence[int], extents: Sequence[range], indices: Sequence[str]) -> str:
    """An element of a constant array as nested `?:`, with one test for each index."""
    if not extents:
        return str(values[0])
    size = len(values) // len(extents[0])
    rows = [values[at : at + size] for at in range(0, len(values), size)]
    texts = [_chosen(row, extents[1:], indices[1:]) for row in rows]
    tests = "".join(
        f"{indices[0]} == {place} ? {text} : "
        for place, text in zip(extents[0], texts[:-1], strict=False)
    )
    return f"({tests}{texts[-1]})"


def _holder(things: Iterable[Thing], index: int) -> Thing:
    """The thing that contains an index."""
    return next(thing for thing in things if thing.first <= index < thing.first + thing.length)


def updates_text(names: Names, updates: Iterable[ex.Statement]) -> str:
    """The updates of an edge, in order."""
    return ", ".join(line.removesuffix(";") for line in _lines(names, updates))


def function_lines(names: Names) -> list[str]:
    """The text of all functions named so far, callees first."""
    return [line for _, function in names.functions.values() for line in _function(names, function)]


def type_text(variable: ex.Variable) -> str:
    """The type of a variable."""
    if variable.is_real:
        return "double"
    return "bool" if variable.is_bool else f"int[{variable.low},{variable.high}]"


def _function(names: Names, function: ex.Function) -> Iterator[str]:
    given = [(f"given_{i}", slot, v) for i, (slot, v) in enumerate(function.parameters)]
    listed = ", ".join(f"{type_text(variable)} {name}" for name, _, variable in given)
    yield f"{type_text(function.result[1])} {names.function(function)}({listed}) {{"
    for thing in _locals(names, function):
        yield f"  {type_text(names.network.locals[thing.first])} {thing.declarator};"
    for name, slot, _ in given:
        yield f"  {names.variable(ex.Slot(slot))} = {name};"
    for line in _lines(names, function.body):
        yield f"  {line}"
    yield "}"


def _locals(names: Names, function: ex.Function) -> list[Thing]:
    """The parameters and local variables of a function, each array as one thing."""
    slots = {slot for slot, _ in function.parameters}
    for one in (*ex.statements_in(function.body), *parts_in(function.body)):
        if isinstance(one, ex.Assignment | ex.VariableValue):
            slots.add(one.slot.first)
    places = {slot + len(names.network.locals) for slot in slots if slot < 0}
    return [t for t in names.locals if places & set(range(t.first, t.first + t.length))]


def _lines(names: Names, statements: Iterable[ex.Statement]) -> Iterator[str]:
    for statement in statements:
        yield from _statement(names, statement)


def _statement(names: Names, statement: ex.Statement) -> Iterator[str]:
    text = names.expression
    match statement:
        case ex.Assignment(slot, value):
            yield f"{names.variable(slot)} = {text(value)};"
        case ex.Reset(clock, value):
            yield f"{names.clock(clock)} = {text(value)};"
        case ex.Invoke():
            yield f"{text(statement)};"
        case ex.If(condition, then, otherwise):
            yield from _nested(names, f"if ({text(condition)}) {{", then)
            if otherwise:
                yield from _nested(names, "else {", otherwise)
        case ex.While(condition, body):
            yield from _nested(names, f"while ({text(condition)}) {{", body)
        case ex.Return(value):
            yield f"return {text(value)};"
        case ex.Missing():
            pass
        case _:
            assert_never(statement)


def _nested(names: Names, head: str, inside: Sequence[ex.Statement]) -> Iterator[str]:
    yield head
    for line in _lines(names, inside):
        yield f"  {line}"
    yield "}"
