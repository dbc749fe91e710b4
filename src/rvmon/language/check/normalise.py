"""Turns bare formulas, response monitors and scopes into trigger and consequent (SEMANTICS 3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce

from rvmon.diagnostics import Span
from rvmon.language.check.scope import Table
from rvmon.language.checked import formula as rv
from rvmon.language.checked.classify import future_part, has_future
from rvmon.language.checked.names_read import names_read
from rvmon.language.checked.operators import Tense
from rvmon.language.checked.properties import PathUnary, Property, StateAtom
from rvmon.language.checked.rewrite import Formulas, chain, rewritten
from rvmon.language.checked.specification import Event, Mode, Role, Signal
from rvmon.language.rules import Refusal
from rvmon.language.rules import requirements as rules

_ALL = rv.Interval()
_not = Formulas().no


def normalised(formula: rv.Formula) -> tuple[Mode, rv.Formula, rv.Formula]:
    """Mode, trigger and consequent of a requirement that is one formula.

    `G(θ → ψ)` is `whenever θ then ψ`, any other unbounded `G ψ` is `whenever true then ψ`, and
    any other φ is `upon start then φ`.
    """
    required = _always(formula)
    if required is None:
        return Mode.UPON, rv.BoundAtom(rv.Bound.START, formula.span), formula
    trigger: rv.Formula | None = None
    while (
        isinstance(required, rv.Binary)
        and required.op is rv.BinaryOp.IMPLIES
        and not future_part(required.left)
    ):
        trigger = required.left if trigger is None else _both(trigger, required.left)
        required = required.right
    return Mode.WHENEVER, trigger or rv.Constant(True, formula.span), required


def _always(formula: rv.Formula) -> rv.Formula | None:
    """The φ of a formula equivalent to `G φ`, such as `G G φ` or `G φ and G ψ`; else `None`."""
    match formula:
        case rv.Unary(op=rv.UnaryOp.ALWAYS, interval=interval) if interval == _ALL:
            return _always(formula.operand) or formula.operand
        case rv.Binary(op=rv.BinaryOp.AND):
            left, right = _always(formula.left), _always(formula.right)
            return None if left is None or right is None else _both(left, right)
        case _:
            return None


def _both(left: rv.Formula, right: rv.Formula) -> rv.Formula:
    return rv.Binary(rv.BinaryOp.AND, left, right, None, joined(left.span, right.span))


def joined(first: Span | None, second: Span | None) -> Span | None:
    """The range over both places; the first one if they are of different texts."""
    if first is None or second is None or first.source is not second.source:
        return first or second
    return first.to(second)


def derived_response(
    table: Table, property_: Property, within: int, place: Span
) -> tuple[rv.Formula, rv.Formula]:
    """Trigger and consequent of a response monitor: on the inputs, the outputs must follow.

    Raises:
        Refusal: the property has another form, a conjunct mixes roles, or there is no output.

    Source: SEMANTICS, section 4, third use.
    """
    goal = property_.formula
    span = property_.span or place
    if not isinstance(goal, PathUnary) or goal.universal or goal.op is not rv.UnaryOp.EVENTUALLY:
        raise Refusal(rules.no_response(span))
    if not isinstance(goal.operand, StateAtom) or goal.interval != rv.Interval():
        raise Refusal(rules.no_response(goal.operand.span or span))
    by_role: dict[Role, list[rv.Formula]] = {Role.INPUT: [], Role.OUTPUT: []}
    for conjunct in chain(goal.operand.formula):
        by_role[_role(table, conjunct, conjunct.span or span)].append(conjunct)
    if not by_role[Role.OUTPUT]:
        raise Refusal(rules.no_output(span))
    inputs = by_role[Role.INPUT]
    trigger = reduce(_both, inputs) if inputs else rv.BoundAtom(rv.Bound.START, place)
    return trigger, _required(by_role[Role.OUTPUT], rv.Interval(0, within))


def _required(outputs: Sequence[rv.Formula], interval: rv.Interval) -> rv.Formula:
    """The consequent: positive outputs must come together, and each negated one must hold."""
    negated = [part for part in outputs if isinstance(part, rv.Unary) and part.op is rv.UnaryOp.NOT]
    positive = [part for part in outputs if part not in negated]
    required: list[rv.Formula] = []
    if positive:
        goal = reduce(_both, positive)
        required.append(rv.Unary(rv.UnaryOp.EVENTUALLY, goal, interval, goal.span))
    required += [rv.Unary(rv.UnaryOp.ALWAYS, part, interval, part.span) for part in negated]
    return reduce(_both, required)


def _role(table: Table, conjunct: rv.Formula, place: Span) -> Role:
    declared: Mapping[str, Signal | Event] = {**table.signals, **table.events}
    roles = {name: declared[name].role for name in names_read(conjunct)}
    for name, role in roles.items():
        if role is None:
            raise Refusal(rules.no_role(place, name))
    kinds = set(roles.values())
    if len(kinds) != 1:
        raise Refusal(rules.mixed_roles(place, {name: str(role) for name, role in roles.items()}))
    return Role(str(kinds.pop()))


def scoped_trigger(
    trigger: rv.Formula, opening: rv.Formula | None, closing: rv.Formula | None
) -> rv.Formula:
    """The trigger restricted to the scope; a trigger `start` becomes the opening of the scope."""
    inside = _inside(opening, closing)
    match trigger:
        case rv.BoundAtom(bound=rv.Bound.START) if opening is not None:
            return rv.Unary(rv.UnaryOp.RISE, inside, None, trigger.span)
        case rv.Constant(value=True):
            return inside
        case _:
            return _and(trigger, inside)


def scoped_consequent(
    consequent: rv.Formula, closing: rv.Formula | None, *, must_close: bool
) -> rv.Formula:
    """The consequent restricted to the scope; with `must_close`, an unclosed scope excuses it."""
    if closing is None:
        return consequent
    required = _until_closed(consequent, closing)
    if not must_close:
        return required
    never = rv.Unary(rv.UnaryOp.ALWAYS, _not(closing), _ALL, closing.span)
    return rv.Binary(rv.BinaryOp.OR, required, never, None, consequent.span)


def _inside(opening: rv.Formula | None, closing: rv.Formula | None) -> rv.Formula:
    if opening is None and closing is not None:
        return _not(rv.Unary(rv.UnaryOp.ONCE, closing, _ALL, closing.span))
    if opening is None or closing is None:
        held = opening or rv.Constant(True)
        return rv.Unary(rv.UnaryOp.ONCE, held, _ALL, held.span)
    opened = _and(opening, _not(closing))
    return rv.Binary(rv.BinaryOp.SINCE, _not(closing), opened, _ALL, opening.span)


def _until_closed(formula: rv.Formula, closing: rv.Formula) -> rv.Formula:
    """The formula over a run that ends right before `closing` next holds.

    What must come has to come before that (`U` takes `not closing` on both sides), and what must
    hold has to hold until then (the dual).
    """
    if not has_future(formula):
        return formula
    # People read the result, so `F`, `G`, `W` and `M` keep short forms of their own instead of
    # being rewritten by `U` and `R`.
    match formula:
        case rv.Unary(op=op, operand=operand, interval=interval, span=span):
            inner = _until_closed(operand, closing)
            match op:
                case rv.UnaryOp.EVENTUALLY:
                    reached = _and(inner, _not(closing))
                    return rv.Binary(rv.BinaryOp.UNTIL, _not(closing), reached, interval, span)
                case rv.UnaryOp.ALWAYS:
                    excused = rv.Binary(rv.BinaryOp.OR, inner, closing, None, operand.span)
                    return rv.Binary(rv.BinaryOp.RELEASE, closing, excused, interval, span)
                case rv.UnaryOp.NEXT:
                    return rv.Unary(op, _and(inner, _not(closing)), None, span)
                case _ if op.entry.tense is Tense.FUTURE:
                    return _until_closed(rewritten(formula), closing)
                case _:
                    return rv.Unary(op, inner, interval, span)
        case rv.Binary(op=op, interval=interval, span=span):
            left = _until_closed(formula.left, closing)
            right = _until_closed(formula.right, closing)
            match op:
                case rv.BinaryOp.UNTIL:
                    left, right = _and(left, _not(closing)), _and(right, _not(closing))
                case rv.BinaryOp.RELEASE:
                    left, right = _or(left, closing), _or(right, closing)
                case rv.BinaryOp.WEAK_UNTIL:
                    right = _or(right, closing)
                case rv.BinaryOp.STRONG_RELEASE:
                    right = _and(right, _not(closing))
                case _ if op.entry.tense is Tense.FUTURE:
                    return _until_closed(rewritten(formula), closing)
            return rv.Binary(op, left, right, interval, span)
        case _:
            return formula


def _and(left: rv.Formula, right: rv.Formula) -> rv.Formula:
    return rv.Binary(rv.BinaryOp.AND, left, right, None, left.span)


def _or(left: rv.Formula, right: rv.Formula) -> rv.Formula:
    return rv.Binary(rv.BinaryOp.OR, left, right, None, left.span)
