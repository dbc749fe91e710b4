"""Variants of requirements without one operand, to find out whether the operand was decisive."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from enum import Enum, auto

from msgspec import Struct, structs

from rvmon.language.checked.classify import has_future, is_pulse, is_timeless
from rvmon.language.checked.formula import Binary, BinaryOp, Formula, Unary, UnaryOp
from rvmon.language.checked.specification import Requirement
from rvmon.language.print import format_formula

_CONNECTIVES = (BinaryOp.AND, BinaryOp.OR, BinaryOp.IMPLIES)


_EITHER_WAY = (BinaryOp.IFF, BinaryOp.XOR, UnaryOp.RISE, UnaryOp.FALL)
"""Operators that are not monotone in their operands."""


class _Change(Enum):
    """The effect of dropping an operand: the formula becomes weaker, stronger, or neither."""

    WEAKER = auto()
    STRONGER = auto()
    OTHER = auto()

    def within(self, op: UnaryOp | BinaryOp, side: str = "") -> _Change:
        """The effect on a formula in which the changed one is an operand (`side`) of `op`."""
        if op in _EITHER_WAY or self is _Change.OTHER:
            return _Change.OTHER
        if op is UnaryOp.NOT or (op is BinaryOp.IMPLIES and side == "left"):
            return _Change.STRONGER if self is _Change.WEAKER else _Change.WEAKER
        return self


class Variant(Struct, frozen=True):
    """A requirement without one operand of `and`, `or` or `->`."""

    part: str  # the operand as text; repeated ones are numbered
    requirement: Requirement  # the requirement without it
    by_failure: bool  # whether, if all values are known, the two differ only if the original fails


def variants_of(requirement: Requirement) -> list[Variant]:
    """All variants of a requirement: of its trigger, then of its consequent."""
    required = requirement.consequent
    is_steady = _is_steady(required)
    changed = [
        (part, replace(requirement, trigger=without, pulse=is_pulse(without)), False)
        for part, without, _ in _without_one(requirement.trigger)
    ]
    changed += [
        (part, replace(requirement, consequent=without), is_steady and change is _Change.WEAKER)
        for part, without, change in _without_one(required)
    ]
    variants: list[Variant] = []
    counts: Counter[str] = Counter()
    for part, other, by_failure in changed:
        text = format_formula(part)
        counts[text] += 1
        name = text if counts[text] == 1 else f"{text} ({counts[text]})"
        # A CTL property belongs to the whole requirement, not to a variant.
        variants.append(Variant(name, replace(other, ctl=None), by_failure))
    return variants


def _is_steady(required: Formula) -> bool:
    """Whether all passing attempts of a consequent pass at the same instant.

    That is the trigger, or the end of an `always` over a timeless operand. Then a weaker consequent
    passes no earlier, and only a failure tells the two apart.
    """
    if isinstance(required, Unary) and required.op is UnaryOp.ALWAYS:
        return is_timeless(required.operand)
    return not has_future(required)


def _without_one(formula: Formula) -> Iterator[tuple[Formula, Formula, _Change]]:
    """Each operand of a connective in a formula, the formula without it, and the effect."""
    match formula:
        case Binary(op=op, left=left, right=right):
            for side, operand in (("left", left), ("right", right)):
                # In a chain `a and b and c`, only a, b and c are operands, not `a and b`.
                chained = isinstance(operand, Binary) and operand.op is op
                if op in _CONNECTIVES and not chained:
                    change = _Change.WEAKER if op is BinaryOp.AND else _Change.STRONGER
                    yield operand, _rest(formula, side), change
                for part, without, change in _without_one(operand):
                    outer = change.within(op, side)
                    yield part, structs.replace(formula, **{side: without}), outer
        case Unary(op=op, operand=operand):
            for part, without, change in _without_one(operand):
                yield part, structs.replace(formula, operand=without), change.within(op)
        case _:
            return


def _rest(formula: Binary, side: str) -> Formula:
    """A binary formula without one side: the other side; for `a -> b` without b, `not a`."""
    if side == "left":
        return formula.right
    if formula.op is BinaryOp.IMPLIES:
        return Unary(UnaryOp.NOT, formula.left)
    return formula.left
