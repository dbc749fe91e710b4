"""Packs the atoms of a plan part: the distinct leaves that read the input.

Numeric expressions are compiled to programs for the stack machine of the core.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Mapping, Sequence
from enum import IntEnum, auto
from typing import assert_never

from msgspec import Struct

from rvmon.core.sections import Numbering, Section, Sections, numbered
from rvmon.errors import RvmonError
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.formula import (
    Arithmetic,
    Bound,
    BoundAtom,
    Captured,
    Compare,
    CompareOp,
    EventAtom,
    FieldValue,
    Literal,
    NowValue,
    Numeric,
    Probe,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    UpdateValue,
    WindowValue,
)
from rvmon.language.checked.rewrite import without_spans
from rvmon.logic.plan import Plan
from rvmon.logic.state_formula import Leaf, events_of, inputs_of, operands
from rvmon.logic.state_graph import captured_names
from rvmon.trace.schema import Kind

DEPTH = 32  # the size of the stack machine's stack, in numbers

_WHOLE, _REAL = 1, 2
_INT64 = 1 << 63


class Code(IntEnum):
    """The operand codes of a program; the codes of operations follow."""

    END = 0
    NUMBER = auto()
    SIGNAL = auto()
    CAPTURED = auto()
    FIELD = auto()
    PREV = auto()
    DELTA = auto()
    RATE = auto()


OPERATIONS = {op: number for number, op in enumerate(NumericOp, len(Code))}
"""The code of each operation: they follow the operand codes, in the order of `NumericOp`."""

NOW = len(Code) + len(OPERATIONS)  # the code of `now`, after all operations
WINDOW = NOW + 1  # the code of the value of a window


_UNKNOWN = Arithmetic(NumericOp.DIV, (Literal(0), Literal(0)))
"""An expression whose value is always unknown, for a captured value known to be unknown."""


class Names:
    """Numbers the names that a plan part reads.

    Attributes:
        signals: by name, its number in the part.
        events: by name, its number in the part.
        key: the event field that identifies instances of `for each`; `None` if there are none.
        captured: by name, the index of a captured value.
        constants: captured values that are already known.
        windows: by window, the slot of its number.
    """

    def __init__(self, plan: Plan, numbering: Numbering) -> None:
        each = [rule.requirement.for_each for rule in plan.rules]
        self.key = next((for_each.value for for_each in each if for_each is not None), None)
        read = {*plan.uses, *([] if self.key is None else [self.key.event])}
        self.signals = numbered([name for name in plan.signals if name in read])
        self.events = numbered([name for name in plan.events if name in read])
        captured = [name for rule in plan.rules for name in rule.captured]
        self.captured = numbered(captured)
        self.constants = plan.constants
        measured = [
            node.amount for node in plan.graph.nodes if isinstance(node.amount, WindowValue)
        ]
        self.windows = {window: place for place, window in enumerate(dict.fromkeys(measured))}
        self.numbering = numbering
        self._spec = plan.spec

    def field(self, event: str, field: str) -> int:
        """The number of a field within its event."""
        return list(self._spec.events[event].fields).index(field)


class Programs:
    """Compiles and packs the numeric expressions of a part."""

    def __init__(self, sections: Sections, names: Names) -> None:
        self._sections = sections
        self._names = names

    def place(self, expression: Numeric) -> int:
        """The index of the program of an expression.

        Raises:
            RvmonError: it is nested too deep, or has a constant that is no int64 and no double.
        """
        words: list[int] = []
        if self._emit(expression, words) >= DEPTH:
            raise RvmonError(
                f"an expression is nested deeper than {DEPTH - 1} numbers: split it up"
            )
        return self._sections.run(Section.CODE, [*words, Code.END])

    def _emit(self, expression: Numeric, words: list[int]) -> int:
        """Append the words of an expression; returns the stack depth that it needs."""
        names = self._names
        match expression:
            case Literal(value=value):
                words.append(_word(Code.NUMBER, self._number(value)))
            case NowValue():
                words.append(_word(NOW, 0))
            case SignalValue(name=name):
                words.append(_word(Code.SIGNAL, names.signals[name]))
            case FieldValue(event=event, field=field):
                words += [_word(Code.FIELD, names.events[event]), names.field(event, field)]
            case UpdateValue(function=function, name=name):
                words.append(_word(Code[function.name], names.signals[name]))
            case Captured(name=name) if name in names.constants:
                known = names.constants[name]
                return self._emit(_UNKNOWN if known is None else Literal(known), words)
            case Captured(name=name):
                words.append(_word(Code.CAPTURED, names.captured[name]))
            case WindowValue():
                words.append(_word(WINDOW, names.windows[without_spans(expression)]))
            case Arithmetic(op=op, args=args):
                return self._operation(op, args, words)
            case _:
                assert_never(expression)
        return 1

    def _operation(self, op: NumericOp, args: Sequence[Numeric], words: list[int]) -> int:
        """Append an operation; one of any number of arguments is folded from the left."""
        at_once = len(args) if op.entry.most else op.entry.least
        depth = 0
        for number, arg in enumerate(args, 1):
            on_stack = min(number, at_once) - 1
            depth = max(depth, on_stack + self._emit(arg, words))
            if number >= at_once:
                words.append(OPERATIONS[op])
        return depth

    def _number(self, value: float | str) -> int:
        """The index of a constant in `NUMBERS`."""
        if isinstance(value, str):
            # Labels are compared as numbers. Their order means nothing: the checker allows only
            # `==` and `!=` on them.
            value = self._names.numbering.labels.get(value, -1)  # −1: equal to no label
        if isinstance(value, int) and -_INT64 <= value < _INT64:
            return self._sections.shared(Section.NUMBERS, _WHOLE, int(value))
        number = exact(value)
        if number is None:
            raise RvmonError(
                f"the whole number {value} has more digits than the core computes with: "
                "write another bound"
            )
        (bits,) = struct.unpack("=q", struct.pack("=d", number))
        return self._sections.shared(Section.NUMBERS, _REAL, bits)


def exact(value: float) -> float | None:
    """A number as a double; `None` if there is no such double."""
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if number == value else None


def _word(code: int, argument: int) -> int:
    return code + 256 * argument


MOST_EVENTS = 8  # the most events whose fields one comparison may read

_COMPARISONS = {op: number for number, op in enumerate(CompareOp)}


class AtomOp(IntEnum):
    """Kinds of atoms."""

    SIGNAL = 0
    REAL = auto()
    COMPARE = auto()
    PAYLOAD = auto()
    EVENT = auto()
    KNOWN_SIGNAL = auto()
    KNOWN_EVENT = auto()
    UPDATED_SIGNAL = auto()
    UPDATED_EVENT = auto()
    CHANGED = auto()
    START = auto()


class Atom(Struct, frozen=True):
    """An atom; names are given by their numbers in the part."""

    op: AtomOp  # its kind
    constant: float = 0.0  # of `REAL`, the constant that the signal is compared with
    compare: int = 0  # the number of the comparison operator
    input: int = -1  # the signal or event; −1 if there is none, or several
    left: int = -1  # index of the program of the left side
    right: int = -1  # index of the program of the right side
    events: tuple[int, ...] = ()  # the events whose fields it reads
    values: tuple[int, ...] = ()  # the signals whose values it reads
    # the signals any update of which may change it, even to an equal value
    updates: tuple[int, ...] = ()
    occurrences: tuple[int, ...] = ()  # the events that it reads, with or without fields
    captured: bool = False  # whether it reads captured values

    @property
    def lone_signals(self) -> tuple[int, ...]:
        """The signals that, if they have a source, make the atom true at single positions."""
        return self.updates if self.op in (AtomOp.UPDATED_SIGNAL, AtomOp.CHANGED) else ()

    @property
    def momentary(self) -> int:
        """The number of names that make it true at single positions, if they have a source."""
        return len(self.lone_signals) + len(self.occurrences) + (self.op is AtomOp.START)


class Atoms:
    """The atoms of a part, numbered in the order in which they are first requested."""

    def __init__(self, plan: Plan, names: Names, programs: Programs) -> None:
        self._plan = plan
        self._names = names
        self._programs = programs
        self._numbers: dict[Atom, int] = {}

    @property
    def all(self) -> Sequence[Atom]:
        """The atoms requested so far, by number."""
        return tuple(self._numbers)

    def number(self, leaf: Leaf) -> int:
        """The number of the atom of a leaf."""
        return self._numbers.setdefault(self._atom(leaf), len(self._numbers))

    def itself(self, number: Numeric) -> int:
        """The atom `x == x`, UNKNOWN where `x` is; its programs compute the number."""
        return self.comparison(Compare(CompareOp.EQ, number, number))

    def comparison(self, compared: Compare) -> int:
        """The number of the general atom of a comparison, compiled to two programs."""
        return self._numbers.setdefault(self._comparison(compared), len(self._numbers))

    def _atom(self, leaf: Leaf) -> Atom:
        names = self._names
        match leaf:
            case SignalAtom(name=name):
                number = names.signals[name]
                return Atom(AtomOp.SIGNAL, input=number, values=(number,))
            case EventAtom(name=name):
                number = names.events[name]
                return Atom(AtomOp.EVENT, input=number, occurrences=(number,))
            case ProbeAtom(probe=Probe.UPDATED, name=name) if name in names.events:
                number = names.events[name]
                return Atom(AtomOp.UPDATED_EVENT, input=number, occurrences=(number,))
            case ProbeAtom(probe=Probe.KNOWN, name=name):
                number = names.signals[name]
                return Atom(AtomOp.KNOWN_SIGNAL, input=number, values=(number,))
            case ProbeAtom(probe=probe, name=name):
                number = names.signals[name]
                op = AtomOp.CHANGED if probe is Probe.CHANGED else AtomOp.UPDATED_SIGNAL
                return Atom(op, input=number, updates=(number,))
            case BoundAtom(bound=Bound.START):
                return Atom(AtomOp.START)
            case Compare():
                return self._real(leaf) or self._comparison(leaf)
            case _:
                raise ValueError(f"{leaf} is not read off the input")

    def _real(self, leaf: Compare) -> Atom | None:
        """The special atom for a real signal against a constant; `None` for other comparisons."""
        match leaf.left, leaf.right:
            case SignalValue(name=name), Literal(value=int() | float() as value):
                op = leaf.op
            case Literal(value=int() | float() as value), SignalValue(name=name):
                op = leaf.op.mirrored
            case _:
                return None
        # Most comparisons are of this kind, so the core has an instruction for it, which compares
        # doubles. A constant that no double equals, or a signal of another kind, takes the exact,
        # general path.
        constant = exact(value)
        if constant is None or self._plan.spec.signals[name].type.kind is not Kind.REAL:
            return None
        number = self._names.signals[name]
        compare = _COMPARISONS[op]
        return Atom(AtomOp.REAL, constant, compare, input=number, values=(number,))

    def _comparison(self, leaf: Compare) -> Atom:
        sides = leaf.left, leaf.right
        names = self._names
        events = tuple(names.events[event] for event in events_of(*sides))
        if len(events) > MOST_EVENTS:
            raise RvmonError(f"a comparison reads fields of more than {MOST_EVENTS} events")
        updated = [part.name for part in operands(*sides) if isinstance(part, UpdateValue)]
        left, right = map(self._programs.place, sides)
        return Atom(
            AtomOp.PAYLOAD if events else AtomOp.COMPARE,
            compare=_COMPARISONS[leaf.op],
            left=left,
            right=right,
            events=events,
            values=_chosen(names.signals, inputs_of(*sides)),
            updates=_chosen(names.signals, updated),
            occurrences=tuple(sorted(events)),
            captured=bool(captured_names(leaf)),
        )


def _chosen(numbers: Mapping[str, int], names: Iterable[str]) -> tuple[int, ...]:
    """The numbers of the names that have one, ascending."""
    return tuple(sorted({numbers[name] for name in names if name in numbers}))
