"""Names of a network as identifiers that other tools accept, and expressions in those names."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import prod
from typing import assert_never

from rvmon.timed.model.expressions import (
    BinaryOperation,
    Choice,
    ClockCompare,
    Constant,
    Deadlock,
    Expression,
    InLocation,
    Lookup,
    PathFormula,
    Slot,
    UnaryOperation,
    VariableValue,
)
from rvmon.timed.model.network import Network
from rvmon.timed.model.operators import BinaryOp, UnaryOp

_KEYWORDS = (
    "after_update and assign before_update bool break broadcast case chan clock "
    "commit const continue deadlock default do double else exists false for forall "
    "guard hybrid if imply init int meta not or priority process progress rate return "
    "scalar select state struct switch sync system trans true typedef urgent void "
    "while"
)
_RESERVED = frozenset(_KEYWORDS.split())
_INDICES = re.compile(r"\[(-?\d+)\]")
_SIGNS = {BinaryOp.AND: "&&", BinaryOp.OR: "||"}


@dataclass(frozen=True, slots=True)
class Thing:
    """A clock, variable or channel, or an array of them, under its new name.

    Attributes:
        first: index of its first element in the network.
        extents: the indices of each dimension in the network; in the text they start at 0.
    """

    name: str
    first: int
    extents: tuple[range, ...]

    @property
    def length(self) -> int:
        """The number of elements."""
        return prod(map(len, self.extents))

    @property
    def declarator(self) -> str:
        """The name with the sizes of an array."""
        return self.name + "".join(f"[{len(extent)}]" for extent in self.extents)

    def element(self, index: int) -> str:
        """The text for an element."""
        rest, places = index - self.first, ""
        for extent in reversed(self.extents):
            rest, place = divmod(rest, len(extent))
            places = f"[{place}]{places}"
        return self.name + places


class Names:
    """The new names of everything in a network.

    Args:
        network: whose names are made identifiers; all that is local becomes global.

    Attributes:
        clocks: in order, arrays as one thing.
        variables: likewise.
        channels: likewise.
        automata: a name for each.
    """

    def __init__(self, network: Network) -> None:
        self._taken: set[str] = set(_RESERVED)
        self.network = network
        self.clocks = self._things([clock.name for clock in network.clocks])
        self.variables = self._things([variable.name for variable in network.variables])
        self.channels = self._things([channel.name for channel in network.channels])
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
            elements = list(members)
            indices = [tuple(map(int, _INDICES.findall(name))) for _, name in elements]
            extents = tuple(
                range(min(places), max(places) + 1) for places in zip(*indices, strict=True)
            )
            things.append(Thing(self._fresh(base), elements[0][0], extents))
        return things

    def location(self, automaton: int, place: int) -> str:
        """The name of a location, unique in its automaton."""
        names = [location.name for location in self.network.automata[automaton].locations]
        name = re.sub(r"\W+", "_", names[place]) or f"location_{place}"
        return f"{name}_" if name in _RESERVED else name

    def clock(self, index: int) -> str:
        """The text for a clock."""
        return _holder(self.clocks, index).element(index)

    def slot(self, slot: Slot, things: Iterable[Thing]) -> str:
        """The text for a variable or channel that the variables may choose."""
        thing = _holder(things, slot.first)
        if not slot.extents:
            return thing.element(slot.first)
        places = []
        for extent, index in zip(slot.extents, slot.indices, strict=True):
            text = self.expression(index)
            places.append(f"[{text} - {extent.start}]" if extent.start else f"[{text}]")
        return thing.name + "".join(places)

    def expression(self, expression: Expression) -> str:
        """An expression, operands in brackets where they need any."""
        match expression:
            case Constant(value):
                return str(value) if value >= 0 else f"({value})"
            case VariableValue(slot):
                return self.slot(slot, self.variables)
            case Lookup(values, extent, index, _):
                chosen = self.expression(index)
                tests = zip(extent, values[:-1], strict=False)
                text = "".join(f"{chosen} == {place} ? {value} : " for place, value in tests)
                return f"({text}{values[-1]})"
            case UnaryOperation(UnaryOp.NOT, operand):
                return f"!({self.expression(operand)})"
            case UnaryOperation(_, operand):
                return f"(-{self.expression(operand)})"
            case BinaryOperation(op, left, right):
                sign = _SIGNS.get(op, str(op))
                return f"({self.expression(left)} {sign} {self.expression(right)})"
            case Choice(condition, then, otherwise):
                parts = map(self.expression, (condition, then, otherwise))
                return "({} ? {} : {})".format(*parts)
            case InLocation(automaton, place):
                return f"{self.automata[automaton]}.{self.location(automaton, place)}"
            case ClockCompare(clock, op, bound):
                return f"{self.clock(clock)} {op} {self.expression(bound)}"
            case Deadlock():
                return "deadlock"
            case PathFormula(op, body, bound):
                limit = "" if bound is None else f"[<={bound}]"
                return f"{op}{limit} {self.expression(body)}"
            case _:
                assert_never(expression)


def _holder(things: Iterable[Thing], index: int) -> Thing:
    """The thing that an index belongs to."""
    return next(thing for thing in things if thing.first <= index < thing.first + thing.length)
