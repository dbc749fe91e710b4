"""Numbers with a fraction, UPPAAL's `double`: random runs have them, and nothing is proved of them.

Each is carried as its 64 bits, so that values of variables are integers throughout.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models.network.expressions import Constant, Expression, Fractional

GRID = 1_000  # steps of simulated time in one unit: all times are whole numbers of them

OPERATIONS: dict[str, Callable[..., float]] = {
    "=": lambda a: a, "<": lambda a, b: a < b, "<=": lambda a, b: a <= b, "==": lambda a, b: a == b,
    "!=": lambda a, b: a != b, ">=": lambda a, b: a >= b, ">": lambda a, b: a > b,
    "+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b,
    "/": lambda a, b: a / b, "%": math.fmod, "<?": min, ">?": max,
    "grid": lambda a: round(a * GRID), "fint": math.trunc, "fabs": abs, "fmod": math.fmod,
    "sqrt": math.sqrt, "pow": math.pow, "hypot": math.hypot, "exp": math.exp, "ln": math.log,
    "log": math.log10, "floor": math.floor, "ceil": math.ceil, "round": round, "sin": math.sin,
    "cos": math.cos, "tan": math.tan,
}  # fmt: skip
"""By sign or name: `=` is the number itself, `grid` are steps of the grid, `double` that of an
integer."""

WHOLE = {"<", "<=", "==", "!=", ">=", ">", "grid", "fint"}  # the operations with an integer result

FUNCTIONS = {name: 1 + (name in ("fmod", "pow", "hypot")) for name in [*OPERATIONS][15:]}
"""The operations that a model calls by name, with the number of their arguments."""


def bits_of(number: float) -> int:
    """The bits of a double; those of 0 are 0.

    >>> number_of(bits_of(-2.5)), bits_of(-0.0)
    (-2.5, 0)
    """
    (bits,) = struct.unpack("<q", struct.pack("<d", number + 0.0))
    return int(bits)


def number_of(bits: int) -> float:
    """The double of some bits."""
    (number,) = struct.unpack("<d", struct.pack("<q", bits))
    return float(number)


def literal(number: float) -> Fractional:
    """A number as it is written."""
    return Fractional("=", (Constant(bits_of(number)),))


def marked(value: Expression, is_real: bool) -> Expression:
    """An expression, with the mark of one that gives bits if it does."""
    return Fractional("=", (value,)) if is_real else value


def operation(name: str, span: Span | None) -> Callable[..., int]:
    """Make a function of integers, or of bits, for an operation.

    Its errors are those of the model: a root, a quotient or a logarithm that does not exist.
    """
    if name == "double":
        return bits_of
    compute, wrap = OPERATIONS[name], int if name in WHOLE else bits_of

    def value(*operands: int) -> int:
        try:
            number = compute(*map(number_of, operands))
            if not math.isfinite(number):
                raise OverflowError
            return wrap(number)
        except (ArithmeticError, ValueError):
            given = ", ".join(f"{number_of(operand):g}" for operand in operands)
            message = f"`{name}` has no value for {given}"
            raise model_error("TA007", message, span, "guard it with a test") from None

    return value


def number_in(value: Expression, bits: int) -> float:
    """The number that an expression has where it gives some bits, or an integer."""
    return number_of(bits) if gives_fraction(value) else bits


def gives_fraction(value: Expression) -> bool:
    """Whether an expression that is made for its value gives bits: the language marks those."""
    return isinstance(value, Fractional) and value.name not in WHOLE
