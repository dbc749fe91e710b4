"""Requirements with one part left out: what a part decides is seen by judging without it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

from rvmon.spec.checked.formula import Binary, BinaryOp, Formula, Unary, UnaryOp
from rvmon.spec.checked.specification import Requirement
from rvmon.spec.checked.tense import is_pulse
from rvmon.spec.print.printer import format_formula

_CONNECTIVES = (BinaryOp.AND, BinaryOp.OR, BinaryOp.IMPLIES)


@dataclass(frozen=True, slots=True)
class Variant:
    """A requirement without one operand of `and`, `or` or `->`.

    Attributes:
        part: the operand, as text; the same twice is numbered.
        requirement: without it.
    """

    part: str
    requirement: Requirement


def variants_of(requirement: Requirement) -> list[Variant]:
    """All variants of a requirement: of its trigger first, then of what it owes."""
    changed = [
        (part, replace(requirement, trigger=without, pulse=is_pulse(without)))
        for part, without in _without_one(requirement.trigger)
    ]
    changed += [
        (part, replace(requirement, consequent=without))
        for part, without in _without_one(requirement.consequent)
    ]
    found: list[Variant] = []
    counts: Counter[str] = Counter()
    for part, other in changed:
        text = format_formula(part)
        counts[text] += 1
        name = text if counts[text] == 1 else f"{text} ({counts[text]})"
        found.append(Variant(name, replace(other, property="", ctl=None)))
    return found


def _without_one(formula: Formula) -> Iterator[tuple[Formula, Formula]]:
    """Each operand of a connective in a formula, and the formula without it."""
    match formula:
        case Binary(op=op, left=left, right=right):
            for side, operand in (("left", left), ("right", right)):
                # Of a chain, the operands are the links, not what they are joined to.
                chained = isinstance(operand, Binary) and operand.op is op
                if op in _CONNECTIVES and not chained:
                    yield operand, _rest(formula, side)
                for part, without in _without_one(operand):
                    yield part, _with(formula, side, without)
        case Unary(operand=operand):
            for part, without in _without_one(operand):
                yield part, replace(formula, operand=without)
        case _:
            return


def _with(formula: Binary, side: str, operand: Formula) -> Formula:
    if side == "left":
        return replace(formula, left=operand)
    return replace(formula, right=operand)


def _rest(formula: Binary, side: str) -> Formula:
    """What is left without one side: the other, or its negation."""
    if side == "left":
        return formula.right
    if formula.op is BinaryOp.IMPLIES:
        return Unary(UnaryOp.NOT, formula.left)
    return formula.left
