"""Numbers with a fraction, UPPAAL's `double`. Random runs use them; proofs refuse them.

Each number is represented by its 64 bits, so that the values of all variables are integers.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models.network.expressions import Constant, Expression, Fractional

GRID = 1_000  # steps of simulated time per unit: all instants are whole numbers of steps

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
"""Operations by sign or name. `=` is the identity, and `grid` converts units of time to steps of
the grid. `double`, which converts an integer, is handled by `operation`."""

WHOLE = {"<", "<=", "==", "!=", ">=", ">", "grid", "fint"}  # the operations with an integer result

FUNCTIONS = {name: 1 + (name in ("fmod", "pow", "hypot")) for name in [*OPERATIONS][15:]}
"""The operations after the 15 signs, which a model calls by name; their number of arguments."""


def bits_of(number: float) -> int:
    """The bits of a double; 0 for both zeros.

    >>> number_of(bits_of(-2.5)), bits_of(-0.0)
    (-2.5, 0)
    """
    (bits,) = struct.unpack("<q", struct.pack("<d", number + 0.0))  # + 0.0 turns −0.0 into 0.0
    return int(bits)


def number_of(bits: int) -> float:
    """The double with the given bits."""
    (number,) = struct.unpack("<d", struct.pack("<q", bits))
    return float(number)


def literal(number: float) -> Fractional:
    """A constant with a fraction."""
    return Fractional("=", (Constant(bits_of(number)),))


def marked(value: Expression, is_real: bool) -> Expression:
    """The expression, marked as giving bits if `is_real`."""
    return Fractional("=", (value,)) if is_real else value


def operation(name: str, span: Span | None) -> Callable[..., int]:
    """Make the function of integers, or of bits, that performs an operation.

    The function raises a `ModelError` where the operation has no finite value, such as the square
    root of −1.
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
    """The number that an expression denotes, given the bits or integer that it evaluates to."""
    return number_of(bits) if gives_fraction(value) else bits


def gives_fraction(value: Expression) -> bool:
    """Whether an expression evaluates to bits: the language marks all such expressions."""
    return isinstance(value, Fractional) and value.name not in WHOLE
