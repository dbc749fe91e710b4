# ruff: noqa: D102, ARG002 - each method is named for a rule of the grammar
"""From the parser's tree of an item to the syntax tree."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any, TypeVar

from lark import Token
from lark.tree import Meta
from lark.visitors import v_args

from rvmon.diagnostics import Span
from rvmon.spec.checked.goals import BinKind
from rvmon.spec.checked.specification import Mode, Role, TimeModel
from rvmon.spec.syntax.build_expressions import Children, ExpressionBuilder, first_of, unquoted
from rvmon.spec.syntax.expressions import Ident, Name
from rvmon.spec.syntax.items import (
    AtEndClause,
    Bare,
    BinSyntax,
    ConstItem,
    CoverItem,
    CoverMonitor,
    CoverpointItem,
    CrossItem,
    DefineItem,
    DelayItem,
    EventItem,
    EventSyntax,
    FieldSyntax,
    ForEachClause,
    GoalClause,
    Header,
    ImportItem,
    LetClause,
    PropertyClause,
    PropertyItem,
    RequirementItem,
    ResponseMonitor,
    RunShareClause,
    SampledClause,
    ScopeClause,
    SignalItem,
    StepsSyntax,
    TagsClause,
    TextClause,
    TimeItem,
    Triggered,
    TypeSyntax,
    UnwantedClause,
    WeightClause,
    WrittenMonitor,
)

_T = TypeVar("_T")


@v_args(meta=True)
class Builder(ExpressionBuilder):
    """Makes the syntax tree of one item; each method is named for a rule of `rv.lark`."""

    def header(self, meta: Meta, children: Children) -> Header:
        title = _string(children[2]) if len(children) > 2 else ""
        return Header(self.ident(children[1]), title, self.span(meta))

    def time_held(self, meta: Meta, _: Children) -> TimeItem:
        return TimeItem(TimeModel.HELD, None, self.span(meta))

    def time_sampled(self, meta: Meta, _: Children) -> TimeItem:
        return TimeItem(TimeModel.SAMPLED, None, self.span(meta))

    def time_clocked(self, meta: Meta, children: Children) -> TimeItem:
        return TimeItem(TimeModel.CLOCKED, children[-1], self.span(meta))

    def delay(self, meta: Meta, children: Children) -> DelayItem:
        return DelayItem(children[-1], self.span(meta))

    def import_item(self, meta: Meta, children: Children) -> ImportItem:
        target = children[1]
        return ImportItem(_string(target), target.type == "NAME", self.span(meta))

    def names(self, meta: Meta, children: Children) -> tuple[Ident, ...]:
        return tuple(map(self.ident, children))

    def bool_type(self, meta: Meta, _: Children) -> TypeSyntax:
        return TypeSyntax("bool", "", (), self.span(meta))

    def int_type(self, meta: Meta, _: Children) -> TypeSyntax:
        return TypeSyntax("int", "", (), self.span(meta))

    def real_type(self, meta: Meta, children: Children) -> TypeSyntax:
        units = [child.strip() for child in children if child.type == "UNIT"]
        return TypeSyntax("real", units[0] if units else "", (), self.span(meta))

    def label_type(self, meta: Meta, children: Children) -> TypeSyntax:
        return TypeSyntax("label", "", children[0], self.span(meta))

    def role(self, meta: Meta, children: Children) -> Role:
        return Role(str(children[0]))

    def ignored(self, meta: Meta, _: Children) -> Span:
        return self.span(meta)

    def stale(self, meta: Meta, children: Children) -> Any:
        return children[1]

    def signals(self, meta: Meta, children: Children) -> SignalItem:
        _, names, type_, *rest = children
        role = first_of([part for part in rest if isinstance(part, Role)])
        ignored = first_of([part for part in rest if isinstance(part, Span)])
        stale = first_of([part for part in rest if not isinstance(part, Role | Span)])
        return SignalItem(names, type_, role, ignored, stale, self.span(meta))

    def event_name(self, meta: Meta, children: Children) -> EventSyntax:
        return EventSyntax(self.ident(children[0]), ())

    def event_call(self, meta: Meta, children: Children) -> EventSyntax:
        token, *fields = children
        return EventSyntax(self.called(token), tuple(_of(FieldSyntax, fields)))

    def field(self, meta: Meta, children: Children) -> FieldSyntax:
        return FieldSyntax(self.ident(children[0]), children[1])

    def events(self, meta: Meta, children: Children) -> EventItem:
        role = first_of(_of(Role, children))
        return EventItem(tuple(_of(EventSyntax, children)), role, self.span(meta))

    def define_name(self, meta: Meta, children: Children) -> DefineItem:
        return DefineItem(self.ident(children[1]), None, children[2], self.span(meta))

    def define_call(self, meta: Meta, children: Children) -> DefineItem:
        name = self.called(children[1])
        return DefineItem(name, children[2], children[-1], self.span(meta))

    def constant(self, meta: Meta, children: Children) -> ConstItem:
        return ConstItem(self.ident(children[1]), children[2], self.span(meta))

    def property(self, meta: Meta, children: Children) -> PropertyItem:
        return PropertyItem(self.ident(children[1]), children[2], self.span(meta))

    # Requirements.

    def requirement(self, meta: Meta, children: Children) -> RequirementItem:
        _, name, *rest = children
        text = _string(rest.pop(0)) if isinstance(rest[0], Token) else ""
        (body, early), *clauses = rest
        clauses = [*early, *clauses]
        return RequirementItem(self.ident(name), text, body, tuple(clauses), self.span(meta))

    def bare(self, meta: Meta, children: Children) -> tuple[Bare, Children]:
        return Bare(children[0]), []

    def upon(self, meta: Meta, children: Children) -> tuple[Triggered, Children]:
        return self._triggered(Mode.UPON, children)

    def whenever(self, meta: Meta, children: Children) -> tuple[Triggered, Children]:
        return self._triggered(Mode.WHENEVER, children)

    def _triggered(self, mode: Mode, children: Children) -> tuple[Triggered, Children]:
        """A trigger with what is required, and the clauses between the two."""
        _, trigger, *clauses, _, consequent = children
        return Triggered(mode, trigger, consequent), clauses

    def response(self, meta: Meta, children: Children) -> tuple[ResponseMonitor, Children]:
        return ResponseMonitor(children[-1], self.span(meta)), []

    def written(self, meta: Meta, children: Children) -> tuple[WrittenMonitor, Children]:
        return WrittenMonitor(self.span(meta)), []

    def shown(self, meta: Meta, children: Children) -> tuple[CoverMonitor, Children]:
        return CoverMonitor(self.span(meta)), []

    def text_clause(self, meta: Meta, children: Children) -> TextClause:
        return TextClause(str(children[0]), _string(children[1]), self.span(meta))

    def tags(self, meta: Meta, children: Children) -> TagsClause:
        return TagsClause(tuple(map(_string, children[1:])), self.span(meta))

    def let(self, meta: Meta, children: Children) -> LetClause:
        return LetClause(self.ident(children[1]), children[2], self.span(meta))

    def for_each(self, meta: Meta, children: Children) -> ForEachClause:
        token = children[2]
        field = Name(unquoted(token), self.span(token))
        return ForEachClause(self.ident(children[1]), field, self.span(meta))

    def at_end(self, meta: Meta, children: Children) -> AtEndClause:
        return AtEndClause(self.ident(children[1]), self.span(meta))

    def owned_property(self, meta: Meta, children: Children) -> PropertyClause:
        return PropertyClause(children[1], self.span(meta))

    def run_share(self, meta: Meta, children: Children) -> RunShareClause:
        at_least = children[0].endswith("least")
        return RunShareClause(at_least, self.literal(meta, children[1:]), self.span(meta))

    def scope_before(self, meta: Meta, children: Children) -> ScopeClause:
        return ScopeClause(None, children[-1], True, self.span(meta))

    def scope_after(self, meta: Meta, children: Children) -> ScopeClause:
        return ScopeClause(children[-1], None, False, self.span(meta))

    def scope_after_until(self, meta: Meta, children: Children) -> ScopeClause:
        return ScopeClause(children[2], children[-1], False, self.span(meta))

    def scope_between(self, meta: Meta, children: Children) -> ScopeClause:
        return ScopeClause(children[2], children[-1], True, self.span(meta))

    # Goals.

    def cover(self, meta: Meta, children: Children) -> CoverItem:
        return CoverItem(self.ident(children[1]), children[2], self.span(meta))

    def bin(self, meta: Meta, children: Children) -> BinSyntax:
        kinds = [BinKind(str(t)) for t in _of(Token, children) if t.type == "UNWANTED"]
        names = [token for token in _of(Token, children) if token.type == "NAME"]
        values = first_of([child for child in children if not isinstance(child, Token)])
        kind = kinds[0] if kinds else BinKind.GOAL
        return BinSyntax(self.ident(names[0]), values, kind, self.span(meta))

    def steps(self, meta: Meta, children: Children) -> StepsSyntax:
        values = tuple(child for child in children if not isinstance(child, Token))
        return StepsSyntax(values, self.span(meta))

    def sampled(self, meta: Meta, children: Children) -> SampledClause:
        return SampledClause(children[1], self.span(meta))

    def goal(self, meta: Meta, children: Children) -> GoalClause:
        return GoalClause(self.literal(meta, children[1:]), self.span(meta))

    def weight(self, meta: Meta, children: Children) -> WeightClause:
        return WeightClause(self.literal(meta, children[1:]), self.span(meta))

    def unwanted(self, meta: Meta, children: Children) -> UnwantedClause:
        return UnwantedClause(BinKind(str(children[0])), children[1], self.span(meta))

    def coverpoint(self, meta: Meta, children: Children) -> CoverpointItem:
        _, name, *rest = children
        bins = tuple(_of(BinSyntax, rest))
        expression = None if isinstance(rest[0], BinSyntax) else rest[0]
        clauses = tuple(rest[len(bins) + (expression is not None) :])
        return CoverpointItem(self.ident(name), expression, bins, clauses, self.span(meta))

    def cross(self, meta: Meta, children: Children) -> CrossItem:
        _, name, points, *clauses = children
        return CrossItem(self.ident(name), points, tuple(clauses), self.span(meta))


def _of(kind: type[_T], children: Iterable[Any]) -> list[_T]:
    return [child for child in children if isinstance(child, kind)]


def _string(token: Token) -> str:
    """The text of a string, or a name as it is."""
    if not token.startswith('"'):
        return unquoted(token)
    return re.sub(r"\\(.)", r"\1", token[1:-1])
