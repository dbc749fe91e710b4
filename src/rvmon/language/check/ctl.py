"""Checks CTL properties, and translates universal ones to formulas over one run.

Source: Maidl, The common fragment of CTL and LTL, FOCS 2000: ACTL^det.
"""

from __future__ import annotations

from typing import assert_never

from msgspec import Struct

from rvmon.diagnostics import Span
from rvmon.language.check.expressions import Checker
from rvmon.language.check.scope import EVERYWHERE, close_name
from rvmon.language.checked.classify import FUTURE, subformulas
from rvmon.language.checked.formula import Binary, BinaryOp, Formula, Interval, Unary, UnaryOp
from rvmon.language.checked.operators import Tense
from rvmon.language.checked.properties import (
    Cover,
    ModelAtom,
    PathBinary,
    PathUnary,
    Property,
    StateAtom,
    StateBinary,
    StateFormula,
    StateNot,
    state_formulas,
)
from rvmon.language.checked.specification import TimeModel
from rvmon.language.print import format_formula
from rvmon.language.rules import Refusal, Reported, short
from rvmon.language.rules import requirements as rules
from rvmon.language.rules import types as type_rules
from rvmon.language.syntax import expressions
from rvmon.language.syntax.items import PropertyClause, RequirementItem, TagsClause, TextClause


def linear_form(property_: Property, place: Span, time: TimeModel) -> Formula:
    """The linear equivalent of a property: a system has the property iff all its runs satisfy it.

    Raises:
        Refusal: the property is not in the fragment; the message names the part and the reason.
    """
    try:
        return _Linear(place, time).of(property_.formula, True)
    except Refusal as refusal:
        raise _not_for_models(refusal, property_) from None


def shown_form(property_: Property, place: Span, time: TimeModel) -> Formula:
    """The formula that a run satisfies if it shows an existential property.

    Raises:
        Refusal: no single run can show it.
    """
    denied = Property(property_.id, property_.text, StateNot(property_.formula), property_.span)
    try:
        formula = linear_form(denied, place, time)
    except Refusal as refusal:
        if any(isinstance(part, ModelAtom) for part in state_formulas(property_.formula)):
            raise
        not_shown = Refusal(rules.not_shown(property_.span or place))
        raise _not_for_models(not_shown, property_) from refusal
    return Unary(UnaryOp.NOT, formula, None, property_.span)


def _not_for_models(refusal: Refusal, property_: Property) -> Refusal:
    """The refusal, without the advice to use `rvmon verify` if it would refuse the property too."""
    for part in state_formulas(property_.formula):
        if isinstance(part, PathUnary | PathBinary) and part.interval and part.interval.low > 0:
            return Refusal(rules.not_for_models(refusal.finding))
    return refusal


class _Linear:
    def __init__(self, place: Span, time: TimeModel) -> None:
        self.place = place
        self.time = time

    def of(self, state: StateFormula, positive: bool) -> Formula:
        """The formula over one run of a state formula, or of its negation."""
        match state:
            case StateAtom(formula=formula, span=span):
                return formula if positive else Unary(UnaryOp.NOT, formula, None, span)
            case ModelAtom(text=text, span=span):
                raise Refusal(rules.reads_model(span or self.place, short(text)))
            case StateNot(operand=operand):
                return self.of(operand, not positive)
            case StateBinary():
                return self.connective(state, positive)
            case PathUnary():
                return self.path_unary(state, positive)
            case PathBinary():
                return self.path_binary(state, positive)
            case _:
                assert_never(state)

    def connective(self, state: StateBinary, positive: bool) -> Formula:
        left, right = state.left, state.right
        match state.op:
            case BinaryOp.AND:
                return self.joined(state, (left, positive), (right, positive), positive)
            case BinaryOp.OR:
                return self.joined(state, (left, positive), (right, positive), not positive)
            case BinaryOp.IMPLIES:
                return self.joined(state, (left, not positive), (right, positive), not positive)
            case _:  # `iff`: both or neither; `xor`, or a negated `iff`: exactly one
                same = (state.op is BinaryOp.IFF) is positive
                both = StateBinary(BinaryOp.AND, left, _signed(right, same), state.span)
                none = StateBinary(
                    BinaryOp.AND, _signed(left, False), _signed(right, not same), state.span
                )
                return self.of(StateBinary(BinaryOp.OR, both, none, state.span), True)

    def joined(
        self,
        state: StateBinary,
        left: tuple[StateFormula, bool],
        right: tuple[StateFormula, bool],
        conjunction: bool,
    ) -> Formula:
        parts = self.of(*left), self.of(*right)
        if conjunction:
            return Binary(BinaryOp.AND, *parts, None, state.span)
        # `AG p or AG q` requires that all runs satisfy the same operand, which no single run shows.
        # It is safe if the operands exclude each other at once, or one is about one instant.
        apart = self.excludes(left, right)
        if not (apart or isinstance(left[0], StateAtom) or isinstance(right[0], StateAtom)):
            raise Refusal(rules.choice_of_paths(state.span or self.place))
        if state.op is BinaryOp.IMPLIES and not left[1]:
            premise = self.of(left[0], True)
            return Binary(BinaryOp.IMPLIES, premise, parts[1], None, state.span)
        return Binary(BinaryOp.OR, *parts, None, state.span)

    def path_unary(self, state: PathUnary, positive: bool) -> Formula:
        span = state.span or self.place
        if state.universal is not positive:
            raise Refusal(rules.some_path(span))
        op = state.op if positive else UnaryOp.of(state.op.entry.dual)
        if op is UnaryOp.NEXT and self.time is TimeModel.HELD:
            raise Refusal(type_rules.step_in_held_time("next", span))
        # `AF φ` is `A[true U φ]`. Nothing excludes `true`, so φ must be about one instant.
        if op is UnaryOp.EVENTUALLY and not isinstance(state.operand, StateAtom):
            raise Refusal(rules.not_on_one_path(span))
        return Unary(op, self.of(state.operand, positive), state.interval, state.span)

    def path_binary(self, state: PathBinary, positive: bool) -> Formula:
        span = state.span or self.place
        if state.universal is not positive:
            raise Refusal(rules.some_path(span))
        op = state.op if positive else BinaryOp.of(state.op.entry.dual)
        left, right = state.left, state.right
        if op in (BinaryOp.UNTIL, BinaryOp.WEAK_UNTIL):
            # The instant at which the right operand comes must be evident at once: either it is
            # about one instant, or the operands have the form `p and φ`, `not p and ψ`.
            plain = isinstance(right, StateAtom) or self.excludes(
                (left, positive), (right, positive)
            )
        else:
            plain = isinstance(left, StateAtom)
        if not plain:
            raise Refusal(rules.not_on_one_path(span))
        parts = self.of(left, positive), self.of(right, positive)
        return Binary(op, *parts, state.interval, state.span)

    def excludes(self, left: tuple[StateFormula, bool], right: tuple[StateFormula, bool]) -> bool:
        """Whether one operand has a conjunct p and the other `not p`, with p about one instant."""
        mine, its = set(_present_parts(*left)), set(_present_parts(*right))
        return any((text, not sign) in its for text, sign in mine)


_PATHS = (expressions.Path, expressions.Quantified, expressions.LeadsTo)
"""The expressions with a path quantifier."""


def _signed(state: StateFormula, positive: bool) -> StateFormula:
    return state if positive else StateNot(state, state.span)


_CONJOINED = {True: (BinaryOp.AND,), False: (BinaryOp.OR, BinaryOp.IMPLIES)}
"""The connectives that are conjunctions as they are (True), or when negated (False)."""


def _present_parts(state: StateFormula, positive: bool) -> list[tuple[str, bool]]:
    """The conjuncts of a state formula that are about one instant, each as text and sign."""
    match state:
        case StateAtom(formula=formula):
            return _signs(formula, positive)
        case StateNot(operand=operand):
            return _present_parts(operand, not positive)
        case StateBinary(op=op, left=left, right=right) if op in _CONJOINED[positive]:
            first = positive or op is BinaryOp.IMPLIES
            return [*_present_parts(left, first), *_present_parts(right, positive)]
        case _:
            return []


def _signs(formula: Formula, positive: bool) -> list[tuple[str, bool]]:
    match formula:
        case Unary(op=UnaryOp.NOT, operand=operand):
            return _signs(operand, not positive)
        case Binary(op=BinaryOp.AND, left=left, right=right) if positive:
            return [*_signs(left, True), *_signs(right, True)]
        case _:
            return [(format_formula(formula), positive)]


def checked_property(
    checker: Checker, name: str, expression: expressions.Expression
) -> Property | None:
    """Check a property; `None`, with a finding, if it has an error."""
    foreign = checker.undeclared(expression)
    for part in foreign:
        close = close_name(checker.table, part.text)
        if close and "." not in part.text:
            checker.report(rules.foreign_name(part.span, part.text, close))
    names = frozenset(part.text for part in foreign)
    formula = checker.collected(_States(checker, names).of, expression)
    span = expression.span
    return None if formula is None else Property(name, span.text, formula, span)


class _States(Struct, frozen=True):
    """Turns expressions into state formulas; `foreign` are the undeclared names, of a model."""

    checker: Checker
    foreign: frozenset[str]

    def of(self, expression: expressions.Expression) -> StateFormula:
        """The state formula of an expression.

        Raises:
            Refusal: it is not a state formula.
            Reported: a part of it has an error.
        """
        span = expression.span
        match expression:
            case expressions.Group(inner=inner):
                return self.of(inner)
            case expressions.Path(universal=universal, op=op, operand=operand):
                held = self.of(operand)
                if op is UnaryOp.NEXT and expression.window is not None:
                    raise Refusal(rules.next_window(expression.window.span))
                interval = self.checker.interval(expression.window, EVERYWHERE)
                within = None if op is UnaryOp.NEXT else interval
                return PathUnary(universal, op, held, within, span)
            case expressions.Quantified(universal=universal, path=path):
                return self._quantified(universal, path)
            case expressions.LeadsTo(left=left, right=right, window=window):
                interval = self.checker.interval(window, EVERYWHERE)
                first, second = self.of(left), self.of(right)
                response = PathUnary(True, UnaryOp.EVENTUALLY, second, interval, right.span)
                required = StateBinary(BinaryOp.IMPLIES, first, response, span)
                return PathUnary(True, UnaryOp.ALWAYS, required, Interval(), span)
        if not self._needs_splitting(expression):
            formula = self.checker.formula(expression, EVERYWHERE)
            for part in subformulas(formula):
                if isinstance(part, Unary | Binary) and part.op.entry.tense is not Tense.PRESENT:
                    raise Refusal(rules.bare_time(part.span or span))
            return StateAtom(formula, span)
        match expression:
            case expressions.Prefix(op=UnaryOp.NOT, operand=operand):
                return StateNot(self.of(operand), span)
            case expressions.Infix(op=joint, left=left, right=right) if (
                joint.entry.tense is Tense.PRESENT
            ):
                return StateBinary(joint, self.of(left), self.of(right), span)
            case expressions.Prefix() | expressions.Infix():
                raise Refusal(rules.bare_time(expression.op_span))
            case _ if any(isinstance(p, _PATHS) for p in expressions.expressions_in(expression)):
                raise Refusal(rules.path_in_number(span))
            case _:
                return ModelAtom(span.text, span)

    def _quantified(self, universal: bool, path: expressions.Expression) -> PathBinary:
        path = expressions.ungrouped(path)
        if not isinstance(path, expressions.Infix) or path.op not in FUTURE:
            raise Refusal(rules.no_path_formula(path.span))
        left, right = self.of(path.left), self.of(path.right)
        interval = self.checker.interval(path.window, EVERYWHERE)
        return PathBinary(universal, path.op, left, right, interval, path.span)

    def _needs_splitting(self, expression: expressions.Expression) -> bool:
        """Whether an expression contains path quantifiers or names of a model."""
        return any(
            isinstance(part, _PATHS)
            or (isinstance(part, expressions.Name) and part.text in self.foreign)
            for part in expressions.expressions_in(expression)
        )


def property_of(checker: Checker, item: RequirementItem) -> Property | None:
    """The CTL property of a requirement; `None` if it has none.

    Raises:
        Reported: the property has an error.
    """
    for clause in item.clauses:
        if isinstance(clause, PropertyClause):
            ctl = checked_property(checker, item.name.text, clause.formula)
            if ctl is None:
                raise Reported
            return ctl
    return None


def checked_goal(checker: Checker, item: RequirementItem, span: Span) -> Cover:
    """Check a requirement with `monitor as cover`, whose place is `span`.

    Raises:
        Refusal: it has an error.
        Reported: it has an error that is already recorded.
    """
    for clause in item.clauses:
        if not isinstance(clause, PropertyClause | TextClause | TagsClause):
            raise Refusal(rules.not_of_a_goal(clause.span))
    ctl = property_of(checker, item)
    if ctl is None:
        raise Refusal(rules.no_goal(span))
    return Cover(item.name.text, shown_form(ctl, span, checker.table.time), item.span, ctl)
