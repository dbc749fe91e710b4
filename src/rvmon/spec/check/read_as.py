"""What an expression stands for, read as a formula or as a number."""

from __future__ import annotations

from rvmon.diagnostics.span import Span
from rvmon.spec.check.choices import either
from rvmon.spec.check.comparisons import alone
from rvmon.spec.check.values import Beside, Chosen, Quantity, Value
from rvmon.spec.checked.formula import (
    Compare,
    CompareOp,
    Formula,
    Literal,
    SignalAtom,
    SignalValue,
)
from rvmon.spec.rules import types as rules
from rvmon.spec.rules.rule import Refusal


def formula_of(value: Value, span: Span) -> Formula:
    """The value as a formula.

    Raises:
        Refusal: it is a number or label.
    """
    if isinstance(value, Beside):
        raise Refusal(alone(value, span))
    match value:
        case Quantity(node=SignalValue(name=name), truth=True):
            return SignalAtom(name, span)
        case Quantity(node=node, truth=True) if node is not None:
            return Compare(CompareOp.EQ, node, Literal(True), span)
        case Quantity(labels=labels):
            raise Refusal(rules.needs_formula(span, "a label" if labels else "a number"))
        case Chosen(condition=condition, chosen=chosen, otherwise=otherwise):
            return either(condition, formula_of(chosen, span), formula_of(otherwise, span), span)
        case _:
            return value


def number_of(value: Value, span: Span) -> Quantity:
    """The value as a number.

    Raises:
        Refusal: it is a formula or label.
    """
    if isinstance(value, Beside):
        raise Refusal(alone(value, span))
    match value:
        case Quantity(truth=False, labels=()):
            return value
        case Quantity(truth=False):
            raise Refusal(rules.label_use(span))
        case Chosen():
            raise Refusal(rules.choice_alone(span))
        case _:
            raise Refusal(rules.needs_number(span))
