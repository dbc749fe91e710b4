"""From the syntax of cover goals, coverpoints and crosses to their checked form."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise, product
from math import ceil, floor, inf, prod

from rvmon.spec.check.comparisons import compared
from rvmon.spec.check.expressions import Checker
from rvmon.spec.check.scope import EVERYWHERE, Quantity, Scope, Value
from rvmon.spec.checked.classify import end_part, future_part
from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Compare,
    CompareOp,
    Constant,
    Formula,
    Interval,
    Literal,
    SignalValue,
    Unary,
    UnaryOp,
    UpdateFunction,
)
from rvmon.spec.checked.goals import Bin, BinKind, Cover, Coverpoint, Cross
from rvmon.spec.checked.operators import Connectives, Tense
from rvmon.spec.checked.rewrite import read
from rvmon.spec.print import format_formula
from rvmon.spec.rules import Refusal, Reported
from rvmon.spec.rules import names as name_rules
from rvmon.spec.rules import properties as rules
from rvmon.spec.rules import requirements as trigger_rules
from rvmon.spec.syntax import expressions, items

_MOST = 10**9
"""The largest goal and weight: what a test will never do is a slip of the pen."""


def checked_cover(checker: Checker, item: items.CoverItem) -> Cover | None:
    """Check a cover goal; `None` if it is wrong, and then that is reported."""
    formula = checker.top(item.formula, EVERYWHERE)
    if formula is None:
        return None
    if end := end_part(formula):
        checker.report(trigger_rules.end_not_alone(end.span or item.span))
        return None
    shown = Unary(UnaryOp.EVENTUALLY, formula, Interval(), item.formula.span)
    return Cover(item.name.text, shown, item.span)


def checked_coverpoint(checker: Checker, item: items.CoverpointItem) -> Coverpoint | None:
    """Check a coverpoint; `None` if it is wrong, and then that is reported."""
    value: Value | None = None
    if item.expression is not None:
        value = checker.value(item.expression, EVERYWHERE)
        if value is None:
            return None
    first: dict[str, items.BinSyntax] = {}

    def made(syntax: items.BinSyntax) -> Bin:
        earlier = first.setdefault(syntax.name.text, syntax)
        if earlier is not syntax:
            places = syntax.name.span, earlier.name.span
            raise Refusal(name_rules.double(syntax.name.text, "bin", *places))
        formula = present(_bin_formula(checker, item.expression, value, syntax))
        if _is_empty(formula, value):
            checker.report(rules.empty_bin(syntax.span))
        return Bin(syntax.name.text, formula, syntax.kind, syntax.span)

    bins = [one for syntax in item.bins if (one := checker.collected(made, syntax)) is not None]
    wrong = len(bins) < len(item.bins)
    found = _clauses(checker, item.clauses)
    for clause in item.clauses:
        if isinstance(clause, items.UnwantedClause):
            checker.report(rules.unwanted_in_point(clause.span))
            wrong = True
    if wrong or found is None:
        return None
    return Coverpoint(item.name.text, tuple(bins), *found, item.span)


def checked_cross(
    checker: Checker,
    item: items.CrossItem,
    points: Mapping[str, Coverpoint],
    declared: Mapping[str, items.CoverpointItem],
) -> Cross:
    """Check a cross.

    Raises:
        Refusal: it is wrong.
        Reported: it is wrong, and that is recorded.
    """
    names = [point.text for point in item.points]
    for number, point in enumerate(item.points):
        if point.text in names[:number]:
            raise Refusal(rules.same_point(point.span, point.text))
        if point.text not in declared:
            raise Refusal(rules.no_coverpoint(point.span, point.text, list(declared)))
        if point.text not in points:
            raise Reported
    bins = [[bin_.name for bin_ in points[name].bins] for name in names]
    combinations = prod(map(len, bins))
    if combinations > rules.MOST_COMBINATIONS:
        raise Refusal(rules.too_many_combinations(item.span, combinations))
    checker.effort.spend(combinations * len(item.clauses), item.span)
    unwanted = {
        kind: _combinations(checker, item, dict(zip(names, bins, strict=True)), kind)
        for kind in (BinKind.IGNORE, BinKind.ILLEGAL)
    }
    found = _clauses(checker, item.clauses)
    if found is None:
        raise Reported
    upon, goal, weight = found
    if upon is None:
        sampled = [one for name in names if (one := points[name].upon) is not None]
        if not all(_alike(one, sampled[0]) for one in sampled):
            raise Refusal(rules.sampled_apart(item.span))
        upon = sampled[0] if sampled else None
    ignored, illegal = unwanted[BinKind.IGNORE], unwanted[BinKind.ILLEGAL]
    return Cross(item.name.text, tuple(names), ignored, illegal, upon, goal, weight, item.span)


def present(formula: Formula) -> Formula:
    """The formula itself, which must not look ahead.

    Raises:
        Refusal: it does.
    """
    ahead = future_part(formula)
    if ahead is not None and ahead.span is not None:
        raise Refusal(rules.looks_ahead(ahead.span))
    end = end_part(formula)
    if end is not None and end.span is not None:
        raise Refusal(trigger_rules.end_not_alone(end.span))
    return formula


def _is_empty(formula: Formula, value: Value | None) -> bool:
    """Whether comparisons of the value with constants, of which a bin consists, exclude all."""
    parts: tuple[Formula, ...] = (formula,)
    if isinstance(formula, Binary) and formula.op is BinaryOp.AND:
        parts = formula.left, formula.right
    if not isinstance(value, Quantity):
        return False
    least: float = -inf
    most: float = inf
    open_ = False
    for part in parts:
        match part:
            case Compare(op=op, left=left, right=Literal(value=int() | float() as bound)):
                if left != value.node:
                    return False
                low, high = _ends(op, bound, whole=value.integral)
                strict = op in (CompareOp.GT, CompareOp.LT) and not value.integral
                open_, least, most = open_ or strict, max(least, low), min(most, high)
            case _:
                return False
    return least > most or (open_ and least == most)


def _ends(op: CompareOp, bound: float, *, whole: bool) -> tuple[float, float]:
    """Between which values a comparison with a constant is true, bounds that are open included."""
    match op:
        case CompareOp.GT | CompareOp.GE:
            first = floor(bound) + 1 if op is CompareOp.GT else ceil(bound)
            return first if whole else bound, inf
        case CompareOp.LT | CompareOp.LE:
            last = ceil(bound) - 1 if op is CompareOp.LT else floor(bound)
            return -inf, last if whole else bound
        case CompareOp.EQ:
            return (ceil(bound), floor(bound)) if whole else (bound, bound)
        case CompareOp.NE:
            return -inf, inf


def _bin_formula(
    checker: Checker,
    expression: expressions.Expression | None,
    value: Value | None,
    bin_: items.BinSyntax,
) -> Formula:
    labelled = isinstance(value, Quantity) and bool(value.labels)
    if bin_.values is None:
        if expression is None or not labelled:
            raise Refusal(rules.bin_without_values(bin_.span))
        return _equals(checker, expression, expressions.Name(bin_.name.text, bin_.name.span))
    if isinstance(bin_.values, expressions.Window):
        return _in_window(checker, expression, bin_.values)
    if isinstance(bin_.values, items.StepsSyntax):
        return _stepped(checker, expression, bin_.values, labelled=labelled)
    return _valued(checker, expression, bin_.values, labelled=labelled)


def _valued(
    checker: Checker,
    expression: expressions.Expression | None,
    wanted: expressions.Expression,
    *,
    labelled: bool,
) -> Formula:
    """That the expression has a value; without one, what is written is the formula."""
    if labelled and expression is not None and isinstance(wanted, expressions.Name):
        return _equals(checker, expression, wanted)
    (found,) = checker.values((wanted,), EVERYWHERE)
    if isinstance(found, Quantity) and found.constant is not None:
        if expression is None:
            raise Refusal(rules.bin_needs_expression(wanted.span))
        return _equals(checker, expression, wanted)
    formula = checker.formula(wanted, EVERYWHERE)
    if isinstance(formula, Constant) and expression is not None:
        holds = checker.formula(expression, EVERYWHERE)
        return holds if formula.value else Unary(UnaryOp.NOT, holds, None, wanted.span)
    return formula


def _stepped(
    checker: Checker,
    expression: expressions.Expression | None,
    steps: items.StepsSyntax,
    *,
    labelled: bool,
) -> Formula:
    """That the last update took the expression to the last value, and those before it to others.

    From each value it came to the next without a third in between.
    """
    if expression is None:
        raise Refusal(rules.bin_needs_expression(steps.span))
    prev = expressions.Ident(UpdateFunction.PREV.value, expression.span)
    before = expressions.Call(prev, (expression,), expression.span)
    span = steps.span
    made: Formula | None = None
    entered: Formula | None = None
    for start, end in pairwise(steps.values):
        now = _valued(checker, expression, end, labelled=labelled)
        was = _valued(checker, before, start, labelled=labelled)
        if _alike(now, _valued(checker, expression, start, labelled=labelled)):
            raise Refusal(rules.same_value(end.span))
        rise = Unary(UnaryOp.RISE, now, None, span)
        came = Binary(BinaryOp.AND, rise, was, None, span)
        if made is not None and entered is not None:
            stayed = Unary(UnaryOp.NOT, entered, None, span)
            latest = Binary(BinaryOp.SINCE, stayed, made, Interval(), span)
            came = Binary(BinaryOp.AND, came, latest, None, span)
        made, entered = came, rise
    assert made is not None, "there are two values at least"
    return made


def _alike(one: Formula, other: Formula) -> bool:
    """Whether two formulas say the same in the same words, wherever they stand."""
    return format_formula(one) == format_formula(other)


def _equals(
    checker: Checker, expression: expressions.Expression, other: expressions.Expression
) -> Formula:
    equation = expressions.Comparison(CompareOp.EQ, expression, other, other.span, other.span)
    return compared(checker, equation, EVERYWHERE)


def _in_window(
    checker: Checker, expression: expressions.Expression | None, window: expressions.Window
) -> Formula:
    """The bounds of a range as comparisons; `inf` bounds nothing."""
    if expression is None or window.low is None:
        raise Refusal(rules.bin_needs_expression(window.span))
    above = CompareOp.GT if window.low_open else CompareOp.GE
    low = expressions.Comparison(above, expression, window.low, window.span, window.span)
    if window.high is None:
        return compared(checker, low, EVERYWHERE)
    below = CompareOp.LT if window.high_open else CompareOp.LE
    high = expressions.Comparison(below, expression, window.high, window.span, window.span)
    left, right = compared(checker, low, EVERYWHERE), compared(checker, high, EVERYWHERE)
    return Binary(BinaryOp.AND, left, right, None, window.span)


def _clauses(
    checker: Checker, clauses: Sequence[items.GoalClauses]
) -> tuple[Formula | None, int, int] | None:
    """Where it is sampled, the goal and the weight; `None` if one is wrong."""
    upon: Formula | None = None
    goal = weight = 1
    for clause in clauses:
        match clause:
            case items.SampledClause(trigger=trigger):
                upon = checker.top(trigger, EVERYWHERE)
                upon = None if upon is None else checker.collected(present, upon)
                if upon is None:
                    return None
            case items.GoalClause(count=count):
                if not _is_count(count, least=1):
                    checker.report(rules.bad_goal(count.span))
                    return None
                goal = int(count.value or 1)
            case items.WeightClause(count=count):
                if not _is_count(count, least=0):
                    checker.report(rules.bad_weight(count.span))
                    return None
                weight = int(count.value or 0)
    return upon, goal, weight


def _is_count(number: expressions.Number, least: int) -> bool:
    value = number.value
    return (
        value is not None and not number.unit and value.denominator == 1 and least <= value <= _MOST
    )


def _combinations(
    checker: Checker, item: items.CrossItem, bins: Mapping[str, Sequence[str]], kind: BinKind
) -> frozenset[tuple[str, ...]]:
    """The combinations for which a clause of that kind holds."""
    scope = Scope(
        {name: Quantity(SignalValue(name), labels=tuple(names)) for name, names in bins.items()}
    )
    tests = [
        (checker.formula(clause.condition, scope), clause)
        for clause in item.clauses
        if isinstance(clause, items.UnwantedClause) and clause.kind is kind
    ]
    for formula, clause in tests:
        if not _about_bins(formula, bins):
            raise Refusal(rules.bad_condition(clause.condition.span))
    return frozenset(
        combination
        for combination in product(*bins.values())
        if any(_holds(f, dict(zip(bins, combination, strict=True))) for f, _ in tests)
    )


class _Booleans(Connectives[bool]):
    """Connectives of what is known."""

    def constant(self, value: bool) -> bool:
        return value

    def no(self, operand: bool) -> bool:
        return not operand

    def both(self, left: bool, right: bool) -> bool:
        return left and right


def _about_bins(formula: Formula, bins: Mapping[str, Sequence[str]]) -> bool:
    """Whether it is made of comparisons of coverpoints with bins, and connectives."""
    match formula:
        case Constant():
            return True
        case Compare(left=left, right=right):
            return all(
                isinstance(side, Literal) or (isinstance(side, SignalValue) and side.name in bins)
                for side in (left, right)
            )
        case Unary(op=UnaryOp.NOT, operand=operand):
            return _about_bins(operand, bins)
        case Binary(op=op, left=left, right=right):
            present = op.entry.tense is Tense.PRESENT
            return present and _about_bins(left, bins) and _about_bins(right, bins)
        case _:
            return False


def _holds(formula: Formula, combination: Mapping[str, str]) -> bool:
    match formula:
        case Constant(value=value):
            return value
        case Compare(op=op, left=left, right=right):
            names = [
                combination[side.name] if isinstance(side, SignalValue) else side
                for side in (left, right)
            ]
            first, second = (n.value if isinstance(n, Literal) else n for n in names)
            return (first == second) is (op is CompareOp.EQ)
        case Unary() | Binary():
            return read(formula, lambda part: _holds(part, combination), _Booleans())
        case _:
            return False
