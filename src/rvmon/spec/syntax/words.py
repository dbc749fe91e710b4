"""The words of the language: which are never names, and which functions are built in."""

from __future__ import annotations

from rvmon.spec.checked.arithmetic import NumericOp

ITEM_WORDS = (
    "spec",
    "time",
    "import",
    "signal",
    "event",
    "define",
    "const",
    "requirement",
    "property",
    "cover",
    "coverpoint",
    "cross",
)
"""Words that start an item; besides, `max delay` does."""

_TEMPORAL_WORDS = (
    *("not", "next", "eventually", "always", "previous", "once", "historically"),
    *("within", "for", "immediately"),
    *("F", "G", "X", "Y", "O", "H", "A", "E", "AG", "AF", "AX", "EG", "EF", "EX"),
)
_OTHER_WORDS = (
    *("upon", "whenever", "then", "and", "or", "xor", "implies", "iff"),
    *("start", "end", "true", "false"),
)

RESERVED = frozenset((*ITEM_WORDS, *_TEMPORAL_WORDS, *_OTHER_WORDS))
"""Words that are never names, unless quoted."""

INFIX_WORDS = frozenset(("until", "since", "unless", "weak", "U", "W", "R", "M", "S"))
"""Operators between formulas; where an operand stands they are names."""

CLAUSE_WORDS = frozenset(
    {
        *("source", "rationale", "severity", "tags", "scope", "at", "let", "monitor"),
        *("goal", "ignore", "illegal"),
    }
)
"""Words that start a clause of an item; elsewhere they are names."""

NOT_UNITS = RESERVED | INFIX_WORDS | CLAUSE_WORDS | frozenset(("input", "output", "stale"))
"""Words that do not count as the unit of a number before them."""

FORMULA_FUNCTIONS = ("rise", "fall", "changed", "held", "known", "updated")
OPERATIONS = tuple(op.value for op in NumericOp if op.is_function)
NUMBER_FUNCTIONS = ("age", *OPERATIONS, "prev", "delta", "rate")
FUNCTIONS = frozenset((*FORMULA_FUNCTIONS, *NUMBER_FUNCTIONS))
"""Functions that are built in."""
