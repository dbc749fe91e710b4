"""From the syntax of a property to checked CTL."""

from __future__ import annotations

from rvmon.diagnostics.span import Span
from rvmon.spec.check.expressions import Checker
from rvmon.spec.check.linear import shown_form
from rvmon.spec.check.table import close_name
from rvmon.spec.check.values import EVERYWHERE
from rvmon.spec.checked.ctl import (
    ModelAtom,
    PathBinary,
    PathUnary,
    Property,
    StateAtom,
    StateBinary,
    StateFormula,
    StateNot,
)
from rvmon.spec.checked.formula import Binary, BinaryOp, Formula, Interval, Unary, UnaryOp
from rvmon.spec.checked.goals import Cover
from rvmon.spec.checked.operators import Tense
from rvmon.spec.checked.tense import FUTURE, subformulas
from rvmon.spec.rules import properties as rules
from rvmon.spec.rules.rule import Refusal, Reported
from rvmon.spec.syntax.expressions import (
    Expression,
    Group,
    Infix,
    LeadsTo,
    Name,
    Path,
    Prefix,
    Quantified,
)
from rvmon.spec.syntax.items import PropertyClause, RequirementItem, TagsClause, TextClause
from rvmon.spec.syntax.walk import expressions_in


def checked_property(checker: Checker, name: str, expression: Expression) -> Property | None:
    """Check a property; `None` if it is wrong, and then that is reported."""
    foreign = _foreign(checker, expression)
    for part in foreign:
        close = close_name(checker.table, part.text)
        if close and "." not in part.text:
            checker.report(rules.foreign_name(part.span, part.text, close))
    names = frozenset(part.text for part in foreign)
    try:
        formula = _state(checker, expression, names)
    except Refusal as refusal:
        checker.report(refusal.finding)
        return None
    except Reported:
        return None
    span = expression.span
    return Property(name, span.text, formula, span)


def _foreign(checker: Checker, expression: Expression) -> list[Name]:
    """The names that the spec does not declare, labels beside a signal not counted."""
    labels = {label for s in checker.table.signals.values() for label in s.type.labels}
    return [
        part
        for part in expressions_in(expression)
        if isinstance(part, Name)
        and not checker.known(part.text, EVERYWHERE)
        and part.text not in labels | checker.table.doubtful
    ]


def _state(checker: Checker, expression: Expression, foreign: frozenset[str]) -> StateFormula:
    span = expression.span
    match expression:
        case Group(inner=inner):
            return _state(checker, inner, foreign)
        case Path(universal=universal, op=op, operand=operand):
            held = _state(checker, operand, foreign)
            if op is UnaryOp.NEXT and expression.window is not None:
                raise Refusal(rules.next_window(expression.window.span))
            interval = checker.interval(expression.window, EVERYWHERE)
            return PathUnary(universal, op, held, None if op is UnaryOp.NEXT else interval, span)
        case Quantified(universal=universal, path=path):
            return _quantified(checker, universal, path, foreign)
        case LeadsTo(left=left, right=right, window=window):
            interval = checker.interval(window, EVERYWHERE)
            first, second = _both(checker, left, right, foreign)
            response = PathUnary(True, UnaryOp.EVENTUALLY, second, interval, right.span)
            owed = StateBinary(BinaryOp.IMPLIES, first, response, span)
            return PathUnary(True, UnaryOp.ALWAYS, owed, Interval(), span)
    return _connected(checker, expression, foreign)


def _connected(checker: Checker, expression: Expression, foreign: frozenset[str]) -> StateFormula:
    """Connectives and atoms."""
    span = expression.span
    if not _needs_splitting(expression, foreign):
        formula = checker.formula(expression, EVERYWHERE)
        _refuse_bare_time(formula, expression)
        return StateAtom(formula, span)
    match expression:
        case Prefix(op=UnaryOp.NOT, operand=operand):
            return StateNot(_state(checker, operand, foreign), span)
        case Infix(op=op, left=left, right=right) if op.entry.tense is Tense.PRESENT:
            return StateBinary(op, *_both(checker, left, right, foreign), span)
        case Prefix() | Infix():
            raise Refusal(rules.bare_time(expression.op_span))
        case _ if any(
            isinstance(p, Path | Quantified | LeadsTo) for p in expressions_in(expression)
        ):
            raise Refusal(rules.path_in_number(span))
        case _:
            return ModelAtom(span.text, span)


def _both(
    checker: Checker, left: Expression, right: Expression, foreign: frozenset[str]
) -> tuple[StateFormula, StateFormula]:
    return _state(checker, left, foreign), _state(checker, right, foreign)


def _quantified(
    checker: Checker, universal: bool, path: Expression, foreign: frozenset[str]
) -> PathBinary:
    while isinstance(path, Group):
        path = path.inner
    if not isinstance(path, Infix) or path.op not in FUTURE:
        raise Refusal(rules.no_path_formula(path.span))
    left, right = _both(checker, path.left, path.right, foreign)
    interval = checker.interval(path.window, EVERYWHERE)
    return PathBinary(universal, path.op, left, right, interval, path.span)


def _needs_splitting(expression: Expression, foreign: frozenset[str]) -> bool:
    """Whether path quantifiers or names of a model stand somewhere inside."""
    return any(
        isinstance(part, Path | Quantified | LeadsTo)
        or (isinstance(part, Name) and part.text in foreign)
        for part in expressions_in(expression)
    )


def _refuse_bare_time(formula: Formula, expression: Expression) -> None:
    for part in subformulas(formula):
        if isinstance(part, Unary | Binary) and part.op.entry.tense is not Tense.PRESENT:
            raise Refusal(rules.bare_time(part.span or expression.span))


def property_of(checker: Checker, item: RequirementItem) -> Property | None:
    """What a requirement states in CTL; `None` if it does not."""
    for clause in item.clauses:
        if isinstance(clause, PropertyClause):
            found = checked_property(checker, item.name.text, clause.formula)
            if found is None:
                raise Reported
            return found
    return None


def checked_goal(checker: Checker, item: RequirementItem, span: Span) -> Cover | None:
    """Check what is monitored as a cover goal; `None` if it is wrong, and then that is reported."""
    try:
        for clause in item.clauses:
            if not isinstance(clause, PropertyClause | TextClause | TagsClause):
                raise Refusal(rules.not_of_a_goal(clause.span))
        ctl = property_of(checker, item)
        if ctl is None:
            raise Refusal(rules.no_goal(span))
        return Cover(item.name.text, shown_form(ctl, span, checker.table.time), item.span, ctl)
    except Refusal as refusal:
        checker.report(refusal.finding)
    except Reported:
        pass
    return None
