"""Numbers and the programs that work them out, as the core runs them on a stack."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from enum import IntEnum, auto
from typing import assert_never

from rvmon.core.packed import Numbering, numbered
from rvmon.core.sections import Section, Sections
from rvmon.errors import RvmonError
from rvmon.logic.plan import Plan
from rvmon.spec.checked.arithmetic import NumericOp
from rvmon.spec.checked.formula import (
    Arithmetic,
    Captured,
    FieldValue,
    Literal,
    NowValue,
    Numeric,
    SignalValue,
    UpdateFunction,
    UpdateValue,
)

DEPTH = 32
"""So many numbers the stack of a program has room for."""

_WHOLE, _REAL = 1, 2
_INT64 = 1 << 63


class Code(IntEnum):
    """What a word of a program does, before the operations."""

    END = 0
    NUMBER = auto()
    SIGNAL = auto()
    CAPTURED = auto()
    FIELD = auto()
    PREV = auto()
    DELTA = auto()
    RATE = auto()


OPERATIONS = {op: number for number, op in enumerate(NumericOp, len(Code))}
"""Their numbers, which go on from there in the order of their table."""

NOW = len(Code) + len(OPERATIONS)
"""The word for `now`, behind all operations."""

_UPDATES = {
    UpdateFunction.PREV: Code.PREV,
    UpdateFunction.DELTA: Code.DELTA,
    UpdateFunction.RATE: Code.RATE,
}


_UNKNOWN = Arithmetic(NumericOp.DIV, (Literal(0), Literal(0)))
"""A number that nobody knows."""


class Names:
    """The numbers of the names that a part of a plan reads.

    Args:
        plan: of the part.
        numbering: of the monitor.

    Attributes:
        signals: by name, its number in the part.
        events: the same.
        key: the event and the field whose values tell instances apart; `None`: nothing does.
        captured: by name, the place of a captured value.
        constants: captured values that are known now.
    """

    def __init__(self, plan: Plan, numbering: Numbering) -> None:
        each = [rule.requirement.for_each for rule in plan.rules]
        self.key = next((one.value for one in each if one is not None), None)
        read = {*plan.uses, *([] if self.key is None else [self.key.event])}
        self.signals = numbered([name for name in plan.signals if name in read])
        self.events = numbered([name for name in plan.events if name in read])
        captured = [name for rule in plan.rules for name in rule.captured]
        self.captured = numbered(captured)
        self.constants = plan.constants
        self.numbering = numbering
        self._spec = plan.spec

    def field(self, event: str, field: str) -> int:
        """The number of a field within its event."""
        return list(self._spec.events[event].fields).index(field)


class Programs:
    """Packs the programs of a part.

    Args:
        sections: of the plan.
        names: of the part.
    """

    def __init__(self, sections: Sections, names: Names) -> None:
        self._sections = sections
        self._names = names

    def place(self, expression: Numeric) -> int:
        """The place of the program of an expression.

        Raises:
            RvmonError: it is too deep, or holds a number that the core does not have.
        """
        words: list[int] = []
        if self._emit(expression, words) >= DEPTH:
            raise RvmonError(
                f"an expression is nested deeper than {DEPTH - 1} numbers: split it up"
            )
        return self._sections.run(Section.CODE, [*words, Code.END])

    def _emit(self, expression: Numeric, words: list[int]) -> int:
        """Add the words of an expression; returns how many numbers lie on the stack at most."""
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
                words.append(_word(_UPDATES[function], names.signals[name]))
            case Captured(name=name) if name in names.constants:
                known = names.constants[name]
                return self._emit(_UNKNOWN if known is None else Literal(known), words)
            case Captured(name=name):
                words.append(_word(Code.CAPTURED, names.captured[name]))
            case Arithmetic(op=op, args=args):
                return self._operation(op, args, words)
            case _:
                assert_never(expression)
        return 1

    def _operation(self, op: NumericOp, args: Sequence[Numeric], words: list[int]) -> int:
        """An operation, from the left if it takes any number of arguments."""
        at_once = len(args) if op.entry.most else op.entry.least
        depth = 0
        for number, arg in enumerate(args, 1):
            on_stack = min(number, at_once) - 1
            depth = max(depth, on_stack + self._emit(arg, words))
            if number >= at_once:
                words.append(OPERATIONS[op])
        return depth

    def _number(self, value: float | str) -> int:
        """The place of a constant."""
        if isinstance(value, str):
            value = self._names.numbering.labels.get(value, -1)  # which no value is
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
