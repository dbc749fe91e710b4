"""Operators and kinds, which a model as written and its network have in common."""

from __future__ import annotations

from enum import StrEnum


class UnaryOp(StrEnum):
    """Operators on one operand."""

    NOT = "not"
    NEGATE = "-"
    INVERT = "~"


class BinaryOp(StrEnum):
    """Operators on two operands."""

    AND = "and"
    OR = "or"
    IMPLY = "imply"
    LT = "<"
    LE = "<="
    EQ = "=="
    NE = "!="
    GE = ">="
    GT = ">"
    ADD = "+"
    SUB = "-"
    MUL = "*"
    DIV = "/"
    MOD = "%"
    BIT_AND = "&"
    BIT_OR = "|"
    BIT_XOR = "^"
    SHIFT_LEFT = "<<"
    SHIFT_RIGHT = ">>"
    MINIMUM = "<?"
    MAXIMUM = ">?"


class PathOp(StrEnum):
    """What must hold of the runs from a state."""

    POSSIBLY = "E<>"
    INVARIANTLY = "A[]"
    EVENTUALLY = "A<>"
    POTENTIALLY_ALWAYS = "E[]"
    SOME_NEXT = "EX"
    EVERY_NEXT = "AX"
    FINALLY = "F"
    """On one run: the body in the end, and `left` until then."""
    GLOBALLY = "G"
    """Its dual on one run: not `left` until the body is false."""
    EVERY_RUN = "A"
    SOME_RUN = "E"


class BaseType(StrEnum):
    """What a declared name holds."""

    INT = "int"
    BOOL = "bool"
    DOUBLE = "double"
    CLOCK = "clock"
    CHANNEL = "chan"
    RECORD = "struct"
    NAMED = "typedef"


class LocationKind(StrEnum):
    """Whether time passes in a location, and whether it must be left next."""

    NORMAL = "normal"
    URGENT = "urgent"
    COMMITTED = "committed"
