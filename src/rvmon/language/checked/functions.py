"""The built-in functions: one entry each, which parser, checker and documentation read.

Functions that are operators of formulas, operations on numbers, or measures of windows have further
data in the entries of these.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum

from msgspec import Struct

from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.formula import Measured, Probe, UpdateFunction
from rvmon.language.checked.operators import UnaryOp, Window


class Argument(Enum):
    """The kinds of arguments, as messages name them."""

    FORMULA = "a formula"
    DURATION = "a duration"
    NUMBER = "a number"
    WHOLE = "a whole number"
    SIGNAL = "the name of a signal"
    SOURCE = "the name of a signal or event"


class Function(Struct, frozen=True):
    """The entry of a built-in function."""

    name: str
    # the operator or measure that a call becomes; `None` for `age`, which stands only in
    # comparisons, and `last`, which stands only in windows
    means: UnaryOp | Probe | UpdateFunction | NumericOp | Measured | None
    arguments: tuple[Argument, ...]
    doc: str  # its value in a few words
    more: bool = False  # whether further arguments like the last may follow
    optional: int = 0  # the number of trailing arguments that may be left out


_OF_UPDATES = (
    Function("changed", Probe.CHANGED, (Argument.SIGNAL,), "x is updated with another value"),
    Function("known", Probe.KNOWN, (Argument.SIGNAL,), "x has a known value"),
    Function("updated", Probe.UPDATED, (Argument.SOURCE,), "x is updated, with any value"),
    Function(
        *("age", None, (Argument.SOURCE,)),
        "the time since the last update of x, compared with a duration",
    ),
    Function(
        *("prev", UpdateFunction.PREV, (Argument.SIGNAL,)), "the value of x before its last update"
    ),
    Function(
        *("delta", UpdateFunction.DELTA, (Argument.SIGNAL, Argument.DURATION)),
        "the difference between the last two values of x; with D, "
        "the increase of x since the first instant of the last D",
        optional=1,
    ),
    Function("rate", UpdateFunction.RATE, (Argument.SIGNAL,), "that difference per second"),
)

LAST = "last"  # `last(n, x)`, which stands only in windows
_COUNTED = (Argument.FORMULA, Argument.DURATION)
_ADDED = (Argument.NUMBER, Argument.DURATION)

_AMOUNTS = (
    *(
        Function(
            *(measured.value, measured, _ADDED if measured.of_numbers else _COUNTED, measured.doc),
            optional=int(measured is not Measured.AGO),
        )
        for measured in Measured
        if measured not in (Measured.DELTA, Measured.MIN, Measured.MAX)
    ),
    Function(
        *("share", Measured.DURATION, _COUNTED),
        "that duration divided by D, compared with a number or `%`",
        optional=1,
    ),
    Function(
        *(LAST, None, (Argument.WHOLE, Argument.NUMBER)),
        "the last n updates of x, or of what φ reads, instead of a D: `mean(last(5, x)) <= 2`",
    ),
)


def _all() -> Iterator[Function]:
    for op in UnaryOp:
        if op.entry.called:
            length = (Argument.DURATION,) if op.entry.window is Window.LENGTH else ()
            yield Function(op.entry.word, op, (Argument.FORMULA, *length), op.entry.doc)
    yield from _OF_UPDATES
    yield from _AMOUNTS
    for operation in NumericOp:
        if operation.is_function:
            entry = operation.entry
            numbers = (Argument.NUMBER,) * entry.least
            many = entry.most is None
            yield Function(operation.value, operation, numbers, entry.doc, many, int(many))


FUNCTIONS = {function.name: function for function in _all()}  # all functions by name
