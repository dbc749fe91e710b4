"""Checks cover goals, coverpoints and crosses."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise, product
from math import ceil, floor, prod

from msgspec import Struct
from msgspec.structs import replace

from rvmon.diagnostics import Span
from rvmon.language.check.comparisons import compared
from rvmon.language.check.expressions import Checker
from rvmon.language.check.scope import EVERYWHERE, Quantity, Scope, Value
from rvmon.language.checked import formula as rv
from rvmon.language.checked.classify import end_part, future_part, subformulas, truth_at
from rvmon.language.checked.operators import Tense
from rvmon.language.checked.properties import Bin, BinKind, Cover, Coverpoint, Cross
from rvmon.language.checked.rewrite import Formulas
from rvmon.language.print import format_formula
from rvmon.language.rules import Refusal, Reported
from rvmon.language.rules import names as name_rules
from rvmon.language.rules import requirements as rules
from rvmon.language.syntax import expressions, items

_MOST = 10**9  # the largest goal and weight; no test reaches more, so it must be a typing error


def checked_cover(checker: Checker, item: items.CoverItem) -> Cover | None:
    """Check a cover goal; `None`, with a finding, if it has an error."""
    formula = checker.top(item.formula, EVERYWHERE)
    if formula is None:
        return None
    if end := end_part(formula):
        checker.report(rules.end_not_alone(end.span or item.span))
        return None
    shown = rv.Unary(rv.UnaryOp.EVENTUALLY, formula, rv.Interval(), item.formula.span)
    return Cover(item.name.text, shown, item.span)


def checked_coverpoint(checker: Checker, item: items.CoverpointItem) -> Coverpoint | None:
    """Check a coverpoint; `None`, with findings, if it has an error."""
    value: Value | None = None
    if item.expression is not None:
        value = checker.value(item.expression, EVERYWHERE)
        if value is None:
            return None
    point = _Point(checker, item.expression, isinstance(value, Quantity) and bool(value.labels))
    first: dict[str, items.BinSyntax] = {}

    def bin_of(syntax: items.BinSyntax) -> Bin:
        earlier = first.setdefault(syntax.name.text, syntax)
        if earlier is not syntax:
            places = syntax.name.span, earlier.name.span
            raise Refusal(name_rules.double(syntax.name.text, "bin", *places))
        formula = present(point.formula(syntax))
        if _is_empty(formula, value):
            checker.report(rules.empty_bin(syntax.span))
        return Bin(syntax.name.text, formula, syntax.kind, syntax.span)

    bins = [one for syntax in item.bins if (one := checker.collected(bin_of, syntax)) is not None]
    wrong = len(bins) < len(item.bins)
    sampling = _clauses(checker, item.clauses)
    for clause in item.clauses:
        if isinstance(clause, items.UnwantedClause):
            checker.report(rules.unwanted_in_point(clause.span))
            wrong = True
    if wrong or sampling is None:
        return None
    return Coverpoint(item.name.text, tuple(bins), *sampling, item.span)


def checked_cross(
    checker: Checker,
    item: items.CrossItem,
    points: Mapping[str, Coverpoint],
    declared: Mapping[str, items.CoverpointItem],
) -> Cross:
    """Check a cross of `declared` coverpoints; `points` are those of them without errors.

    Raises:
        Refusal: it has an error.
        Reported: it has an error that is already recorded, or one of its coverpoints has one.
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
    # Each clause is evaluated for each combination, which is slow with large macros.
    checker.effort.spend(combinations * len(item.clauses), item.span)
    unwanted = {
        kind: _combinations(checker, item, dict(zip(names, bins, strict=True)), kind)
        for kind in (BinKind.IGNORE, BinKind.ILLEGAL)
    }
    sampling = _clauses(checker, item.clauses)
    if sampling is None:
        raise Reported
    upon, goal, weight = sampling
    if upon is None:
        sampled = [one for name in names if (one := points[name].upon) is not None]
        if not all(_alike(one, sampled[0]) for one in sampled):
            raise Refusal(rules.sampled_apart(item.span))
        upon = sampled[0] if sampled else None
    ignored, illegal = unwanted[BinKind.IGNORE], unwanted[BinKind.ILLEGAL]
    return Cross(item.name.text, tuple(names), ignored, illegal, upon, goal, weight, item.span)


def present(formula: rv.Formula) -> rv.Formula:
    """The formula itself, which must not refer to the future or to `end`.

    Raises:
        Refusal: it does.
    """
    ahead = future_part(formula)
    if ahead is not None and ahead.span is not None:
        raise Refusal(rules.looks_ahead(ahead.span))
    end = end_part(formula)
    if end is not None and end.span is not None:
        raise Refusal(rules.end_not_alone(end.span))
    return formula


def _is_empty(formula: rv.Formula, value: Value | None) -> bool:
    """Whether no value satisfies a bin that compares `value` with constants.

    False for bins of any other form.
    """
    parts: tuple[rv.Formula, ...] = (formula,)
    if isinstance(formula, rv.Binary) and formula.op is rv.BinaryOp.AND:
        parts = formula.left, formula.right
    if not isinstance(value, Quantity):
        return False
    limits: list[tuple[rv.CompareOp, Fraction]] = []
    for part in parts:
        match part:
            case rv.Compare(op=op, left=left, right=rv.Literal(value=int() | float() as bound)) if (
                left == value.node
            ):
                limits.append((op, Fraction(bound)))
            case _:
                return False
    # If any value satisfies all comparisons, so does a bound, a value beyond all bounds, or the
    # middle of two neighbouring ones.
    bounds = sorted(bound for _, bound in limits)
    middles = ((one + other) / 2 for one, other in pairwise(bounds))
    tried: Iterable[Fraction | int] = (bounds[0] - 1, *bounds, *middles, bounds[-1] + 1)
    if value.integral:
        tried = [whole for one in tried for whole in (floor(one), ceil(one))]
    return not any(all(op.holds(one, bound) for op, bound in limits) for one in tried)


class _Point(Struct, frozen=True):
    """Makes the formulas of a coverpoint's bins, from values of its expression if it has one."""

    checker: Checker
    expression: expressions.Expression | None
    labelled: bool

    def formula(self, bin_: items.BinSyntax) -> rv.Formula:
        """The formula that is true where a bin is hit."""
        match bin_.values:
            case None if self.labelled:
                return self._valued(expressions.Name(bin_.name.text, bin_.name.span))
            case None:
                raise Refusal(rules.bin_without_values(bin_.span))
            case expressions.Window() as window:
                return self._in_window(window)
            case items.StepsSyntax() as steps:
                return self._stepped(steps)
            case wanted:
                return self._valued(wanted)

    def _valued(self, wanted: expressions.Expression) -> rv.Formula:
        """The condition that the expression has the wanted value, or the bin's own formula."""
        expression = self.expression
        if self.labelled and isinstance(wanted, expressions.Name):
            return self._compared(rv.CompareOp.EQ, wanted, wanted.span)
        (value,) = self.checker.values((wanted,), EVERYWHERE)
        if isinstance(value, Quantity) and value.constant is not None:
            return self._compared(rv.CompareOp.EQ, wanted, wanted.span)
        formula = self.checker.formula(wanted, EVERYWHERE)
        if isinstance(formula, rv.Constant) and expression is not None:
            holds = self.checker.formula(expression, EVERYWHERE)
            return holds if formula.value else rv.Unary(rv.UnaryOp.NOT, holds, None, wanted.span)
        return formula

    def _stepped(self, steps: items.StepsSyntax) -> rv.Formula:
        """The condition that the last updates took the expression through the steps in order.

        The expression had no other value between two steps.
        """
        span, expression = steps.span, self.expression
        if expression is None:
            raise Refusal(rules.bin_needs_expression(span))
        prev = expressions.Ident(rv.UpdateFunction.PREV.value, expression.span)
        call = expressions.Call(prev, (expression,), expression.span)
        before, make = replace(self, expression=call), Formulas(span)
        taken: rv.Formula | None = None
        entered: rv.Formula | None = None
        for start, end in pairwise(steps.values):
            # `prev` of the expression is its value before the update that made it `end`.
            now, was = self._valued(end), before._valued(start)
            if _alike(now, self._valued(start)):
                raise Refusal(rules.same_value(end.span))
            rise = rv.Unary(rv.UnaryOp.RISE, now, None, span)
            came = make.both(rise, was)
            # The value that is left now must have been entered by the previous step, so it was not
            # entered again (`entered`) since that step (`taken`).
            if taken is not None and entered is not None:
                stayed = rv.Unary(rv.UnaryOp.NOT, entered, None, span)
                came = make.both(came, make.since(stayed, taken, rv.Interval()))
            taken, entered = came, rise
        assert taken is not None, "there are two values at least"
        return taken

    def _in_window(self, window: expressions.Window) -> rv.Formula:
        """The condition that the expression lies in a range; `inf` is no bound."""
        if self.expression is None or window.low is None:
            raise Refusal(rules.bin_needs_expression(window.span))
        above = rv.CompareOp.GT if window.low_open else rv.CompareOp.GE
        low = self._compared(above, window.low, window.span)
        if window.high is None:
            return low
        below = rv.CompareOp.LT if window.high_open else rv.CompareOp.LE
        high = self._compared(below, window.high, window.span)
        return rv.Binary(rv.BinaryOp.AND, low, high, None, window.span)

    def _compared(self, op: rv.CompareOp, other: expressions.Expression, span: Span) -> rv.Formula:
        if self.expression is None:
            raise Refusal(rules.bin_needs_expression(other.span))
        side = expressions.Comparison(op, self.expression, other, span, span)
        return compared(self.checker, side, EVERYWHERE)


def _alike(formula: rv.Formula, other: rv.Formula) -> bool:
    """Whether two formulas have the same text, regardless of their places."""
    return format_formula(formula) == format_formula(other)


def _clauses(
    checker: Checker, clauses: Sequence[items.GoalClauses]
) -> tuple[rv.Formula | None, int, int] | None:
    """The formula at which a point is sampled, its goal and weight; `None` if one has an error."""
    upon: rv.Formula | None = None
    counts = {"goal": 1, "weight": 1}
    for clause in clauses:
        match clause:
            case items.SampledClause(trigger=trigger):
                upon = checker.top(trigger, EVERYWHERE)
                upon = None if upon is None else checker.collected(present, upon)
                if upon is None:
                    return None
            case items.CountClause(word=word, count=count):
                number, least = count.value, int(word == "goal")
                whole = number is not None and not count.unit and number.denominator == 1
                if number is None or not whole or not least <= number <= _MOST:
                    wrong = rules.bad_goal if word == "goal" else rules.bad_weight
                    checker.report(wrong(count.span))
                    return None
                counts[word] = int(number)
    return upon, counts["goal"], counts["weight"]


def _combinations(
    checker: Checker, item: items.CrossItem, bins: Mapping[str, Sequence[str]], kind: BinKind
) -> frozenset[tuple[str, ...]]:
    """The combinations of bins for which some clause of the kind holds."""
    scope = Scope(
        {name: Quantity(rv.SignalValue(name), labels=tuple(names)) for name, names in bins.items()}
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


def _about_bins(formula: rv.Formula, bins: Mapping[str, Sequence[str]]) -> bool:
    """Whether a formula consists of comparisons between coverpoints and bins, and connectives."""
    for part in subformulas(formula):
        match part:
            case rv.Constant():
                pass
            case rv.Unary(op=op) | rv.Binary(op=op) if op.entry.tense is Tense.PRESENT:
                pass
            case rv.Compare(left=left, right=right) if all(
                isinstance(side, rv.Literal)
                or (isinstance(side, rv.SignalValue) and side.name in bins)
                for side in (left, right)
            ):
                pass
            case _:
                return False
    return True


def _holds(formula: rv.Formula, combination: Mapping[str, str]) -> bool:
    """Whether a formula about bins holds for a combination, the bin of each coverpoint by name."""
    facts: dict[Hashable, bool] = {}
    for part in subformulas(formula):
        if isinstance(part, rv.Compare):
            left, right = (
                rv.Literal(combination[side.name]) if isinstance(side, rv.SignalValue) else side
                for side in (part.left, part.right)
            )
            facts[rv.CompareOp.EQ, part.left, part.right] = left == right
    return truth_at(formula, facts) is True
