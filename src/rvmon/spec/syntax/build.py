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
from rvmon.spec.syntax import items
from rvmon.spec.syntax.build_expressions import Children, ExpressionBuilder, first_of, unquoted
from rvmon.spec.syntax.expressions import Ident, Name

_T = TypeVar("_T")


@v_args(meta=True)
class Builder(ExpressionBuilder):
    """Makes the syntax tree of one item; each method is named for a rule of `rv.lark`."""

    def header(self, meta: Meta, children: Children) -> items.Header:
        title = _string(children[2]) if len(children) > 2 else ""
        return items.Header(self.ident(children[1]), title, self.span(meta))

    def time_held(self, meta: Meta, _: Children) -> items.TimeItem:
        return items.TimeItem(TimeModel.HELD, None, self.span(meta))

    def time_sampled(self, meta: Meta, _: Children) -> items.TimeItem:
        return items.TimeItem(TimeModel.SAMPLED, None, self.span(meta))

    def time_clocked(self, meta: Meta, children: Children) -> items.TimeItem:
        return items.TimeItem(TimeModel.CLOCKED, children[-1], self.span(meta))

    def delay(self, meta: Meta, children: Children) -> items.DelayItem:
        return items.DelayItem(children[-1], self.span(meta))

    def import_item(self, meta: Meta, children: Children) -> items.ImportItem:
        target = children[1]
        return items.ImportItem(_string(target), target.type == "NAME", self.span(meta))

    def names(self, meta: Meta, children: Children) -> tuple[Ident, ...]:
        return tuple(map(self.ident, children))

    def bool_type(self, meta: Meta, _: Children) -> items.TypeSyntax:
        return items.TypeSyntax("bool", "", (), self.span(meta))

    def int_type(self, meta: Meta, _: Children) -> items.TypeSyntax:
        return items.TypeSyntax("int", "", (), self.span(meta))

    def real_type(self, meta: Meta, children: Children) -> items.TypeSyntax:
        units = [child.strip() for child in children if child.type == "UNIT"]
        return items.TypeSyntax("real", units[0] if units else "", (), self.span(meta))

    def label_type(self, meta: Meta, children: Children) -> items.TypeSyntax:
        return items.TypeSyntax("label", "", children[0], self.span(meta))

    def role(self, meta: Meta, children: Children) -> Role:
        return Role(str(children[0]))

    def ignored(self, meta: Meta, _: Children) -> Span:
        return self.span(meta)

    def stale(self, meta: Meta, children: Children) -> Any:
        return children[1]

    def signals(self, meta: Meta, children: Children) -> items.SignalItem:
        _, names, type_, *rest = children
        role = first_of([part for part in rest if isinstance(part, Role)])
        ignored = first_of([part for part in rest if isinstance(part, Span)])
        stale = first_of([part for part in rest if not isinstance(part, Role | Span)])
        return items.SignalItem(names, type_, role, ignored, stale, self.span(meta))

    def event_name(self, meta: Meta, children: Children) -> items.EventSyntax:
        return items.EventSyntax(self.ident(children[0]), ())

    def event_call(self, meta: Meta, children: Children) -> items.EventSyntax:
        token, *fields = children
        return items.EventSyntax(self.called(token), tuple(_of(items.FieldSyntax, fields)))

    def field(self, meta: Meta, children: Children) -> items.FieldSyntax:
        return items.FieldSyntax(self.ident(children[0]), children[1])

    def events(self, meta: Meta, children: Children) -> items.EventItem:
        role = first_of(_of(Role, children))
        return items.EventItem(tuple(_of(items.EventSyntax, children)), role, self.span(meta))

    def define_name(self, meta: Meta, children: Children) -> items.DefineItem:
        return items.DefineItem(self.ident(children[1]), None, children[2], self.span(meta))

    def define_call(self, meta: Meta, children: Children) -> items.DefineItem:
        name = self.called(children[1])
        return items.DefineItem(name, children[2], children[-1], self.span(meta))

    def constant(self, meta: Meta, children: Children) -> items.ConstItem:
        return items.ConstItem(self.ident(children[1]), children[2], self.span(meta))

    def property(self, meta: Meta, children: Children) -> items.PropertyItem:
        return items.PropertyItem(self.ident(children[1]), children[2], self.span(meta))

    # Requirements.

    def requirement(self, meta: Meta, children: Children) -> items.RequirementItem:
        _, name, *rest = children
        text = _string(rest.pop(0)) if isinstance(rest[0], Token) else ""
        (body, early), *clauses = rest
        clauses = [*early, *clauses]
        return items.RequirementItem(self.ident(name), text, body, tuple(clauses), self.span(meta))

    def bare(self, meta: Meta, children: Children) -> tuple[items.Bare, Children]:
        return items.Bare(children[0]), []

    def upon(self, meta: Meta, children: Children) -> tuple[items.Triggered, Children]:
        return self._triggered(Mode.UPON, children)

    def whenever(self, meta: Meta, children: Children) -> tuple[items.Triggered, Children]:
        return self._triggered(Mode.WHENEVER, children)

    def _triggered(self, mode: Mode, children: Children) -> tuple[items.Triggered, Children]:
        """A trigger with what is required, and the clauses between the two."""
        _, trigger, *clauses, _, consequent = children
        return items.Triggered(mode, trigger, consequent), clauses

    def response(self, meta: Meta, children: Children) -> tuple[items.ResponseMonitor, Children]:
        return items.ResponseMonitor(children[-1], self.span(meta)), []

    def written(self, meta: Meta, children: Children) -> tuple[items.WrittenMonitor, Children]:
        return items.WrittenMonitor(self.span(meta)), []

    def shown(self, meta: Meta, children: Children) -> tuple[items.CoverMonitor, Children]:
        return items.CoverMonitor(self.span(meta)), []

    def text_clause(self, meta: Meta, children: Children) -> items.TextClause:
        return items.TextClause(str(children[0]), _string(children[1]), self.span(meta))

    def tags(self, meta: Meta, children: Children) -> items.TagsClause:
        return items.TagsClause(tuple(map(_string, children[1:])), self.span(meta))

    def let(self, meta: Meta, children: Children) -> items.LetClause:
        return items.LetClause(self.ident(children[1]), children[2], self.span(meta))

    def for_each(self, meta: Meta, children: Children) -> items.ForEachClause:
        token = children[2]
        field = Name(unquoted(token), self.span(token))
        return items.ForEachClause(self.ident(children[1]), field, self.span(meta))

    def at_end(self, meta: Meta, children: Children) -> items.AtEndClause:
        return items.AtEndClause(self.ident(children[1]), self.span(meta))

    def owned_property(self, meta: Meta, children: Children) -> items.PropertyClause:
        return items.PropertyClause(children[1], self.span(meta))

    def run_share(self, meta: Meta, children: Children) -> items.RunShareClause:
        at_least = children[0].endswith("least")
        return items.RunShareClause(at_least, self.literal(meta, children[1:]), self.span(meta))

    def scope_before(self, meta: Meta, children: Children) -> items.ScopeClause:
        return items.ScopeClause(None, children[-1], True, self.span(meta))

    def scope_after(self, meta: Meta, children: Children) -> items.ScopeClause:
        return items.ScopeClause(children[-1], None, False, self.span(meta))

    def scope_after_until(self, meta: Meta, children: Children) -> items.ScopeClause:
        return items.ScopeClause(children[2], children[-1], False, self.span(meta))

    def scope_between(self, meta: Meta, children: Children) -> items.ScopeClause:
        return items.ScopeClause(children[2], children[-1], True, self.span(meta))

    # Goals.

    def cover(self, meta: Meta, children: Children) -> items.CoverItem:
        return items.CoverItem(self.ident(children[1]), children[2], self.span(meta))

    def bin(self, meta: Meta, children: Children) -> items.BinSyntax:
        kinds = [BinKind(str(t)) for t in _of(Token, children) if t.type == "UNWANTED"]
        names = [token for token in _of(Token, children) if token.type == "NAME"]
        values = first_of([child for child in children if not isinstance(child, Token)])
        kind = kinds[0] if kinds else BinKind.GOAL
        return items.BinSyntax(self.ident(names[0]), values, kind, self.span(meta))

    def steps(self, meta: Meta, children: Children) -> items.StepsSyntax:
        values = tuple(child for child in children if not isinstance(child, Token))
        return items.StepsSyntax(values, self.span(meta))

    def sampled(self, meta: Meta, children: Children) -> items.SampledClause:
        return items.SampledClause(children[1], self.span(meta))

    def goal(self, meta: Meta, children: Children) -> items.GoalClause:
        return items.GoalClause(self.literal(meta, children[1:]), self.span(meta))

    def weight(self, meta: Meta, children: Children) -> items.WeightClause:
        return items.WeightClause(self.literal(meta, children[1:]), self.span(meta))

    def unwanted(self, meta: Meta, children: Children) -> items.UnwantedClause:
        return items.UnwantedClause(BinKind(str(children[0])), children[1], self.span(meta))

    def coverpoint(self, meta: Meta, children: Children) -> items.CoverpointItem:
        _, name, *rest = children
        bins = tuple(_of(items.BinSyntax, rest))
        expression = None if isinstance(rest[0], items.BinSyntax) else rest[0]
        clauses = tuple(rest[len(bins) + (expression is not None) :])
        return items.CoverpointItem(self.ident(name), expression, bins, clauses, self.span(meta))

    def cross(self, meta: Meta, children: Children) -> items.CrossItem:
        _, name, points, *clauses = children
        return items.CrossItem(self.ident(name), points, tuple(clauses), self.span(meta))


def _of(kind: type[_T], children: Iterable[Any]) -> list[_T]:
    return [child for child in children if isinstance(child, kind)]


def _string(token: Token) -> str:
    """The text of a string, or a name as it is."""
    if not token.startswith('"'):
        return unquoted(token)
    return re.sub(r"\\(.)", r"\1", token[1:-1])
