# ruff: noqa: D102 - each method is named for a rule of the grammar
"""From the parser's tree of an item to the syntax tree."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, TypeVar

from lark import Token
from lark.tree import Meta
from lark.visitors import v_args

from rvmon.diagnostics import Span
from rvmon.language.checked.goals import BinKind
from rvmon.language.checked.specification import Mode, Role, TimeModel
from rvmon.language.syntax import items
from rvmon.language.syntax.build_expressions import (
    Children,
    ExpressionBuilder,
    Maker,
    first_of,
    unquoted,
)
from rvmon.language.syntax.expressions import Name

_T = TypeVar("_T")


@v_args(meta=True)
class Builder(ExpressionBuilder):
    """Makes the syntax tree of one item; a maker or a method for each rule of `rv.lark`."""

    makers: ClassVar[Mapping[str, Maker]] = {
        **ExpressionBuilder.makers,
        "import_item": lambda _, parts, span: items.ImportItem(
            _string(parts[1]), parts[1].type == "NAME", span
        ),
        "time_held": lambda _b, _parts, span: items.TimeItem(TimeModel.HELD, None, span),
        "time_sampled": lambda _b, _parts, span: items.TimeItem(TimeModel.SAMPLED, None, span),
        "time_clocked": lambda _, parts, span: items.TimeItem(TimeModel.CLOCKED, parts[-1], span),
        "delay": lambda _, parts, span: items.DelayItem(parts[-1], span),
        "names": lambda b, parts, _: tuple(map(b.ident, parts)),
        "bool_type": lambda _b, _parts, span: items.TypeSyntax("bool", "", (), span),
        "int_type": lambda _b, _parts, span: items.TypeSyntax("int", "", (), span),
        "label_type": lambda _, parts, span: items.TypeSyntax("label", "", parts[0], span),
        "role": lambda _b, parts, _span: Role(str(parts[0])),
        "ignored": lambda _b, _parts, span: span,
        "stale": lambda _b, parts, _span: parts[1],
        "event_name": lambda b, parts, _: items.EventSyntax(b.ident(parts[0]), ()),
        "event_call": lambda b, parts, _: items.EventSyntax(b.called(parts[0]), tuple(parts[1:])),
        "field": lambda b, parts, _: items.FieldSyntax(b.ident(parts[0]), parts[1]),
        "define_name": lambda b, parts, span: items.DefineItem(
            b.ident(parts[1]), None, parts[2], span
        ),
        "define_call": lambda b, parts, span: items.DefineItem(
            b.called(parts[1]), parts[2], parts[-1], span
        ),
        "constant": lambda b, parts, span: items.ConstItem(b.ident(parts[1]), parts[2], span),
        "property": lambda b, parts, span: items.PropertyItem(b.ident(parts[1]), parts[2], span),
        "bare": lambda _b, parts, _span: (items.Bare(parts[0]), []),
        "upon": lambda _b, parts, _span: _triggered(Mode.UPON, parts),
        "whenever": lambda _b, parts, _span: _triggered(Mode.WHENEVER, parts),
        "response": lambda _, parts, span: (items.ResponseMonitor(parts[-1], span), []),
        "written": lambda _b, _parts, span: (items.WrittenMonitor(span), []),
        "shown": lambda _b, _parts, span: (items.CoverMonitor(span), []),
        "text_clause": lambda _, parts, span: items.TextClause(
            str(parts[0]), _string(parts[1]), span
        ),
        "tags": lambda _, parts, span: items.TagsClause(tuple(map(_string, parts[1:])), span),
        "let": lambda b, parts, span: items.LetClause(b.ident(parts[1]), parts[2], span),
        "at_end": lambda b, parts, span: items.AtEndClause(b.ident(parts[1]), span),
        "owned_property": lambda _, parts, span: items.PropertyClause(parts[1], span),
        "scope_before": lambda _, parts, span: items.ScopeClause(None, parts[-1], True, span),
        "scope_after": lambda _, parts, span: items.ScopeClause(parts[-1], None, False, span),
        "scope_after_until": lambda _, parts, span: items.ScopeClause(
            parts[2], parts[-1], False, span
        ),
        "scope_between": lambda _, parts, span: items.ScopeClause(parts[2], parts[-1], True, span),
        "cover": lambda b, parts, span: items.CoverItem(b.ident(parts[1]), parts[2], span),
        "cross": lambda b, parts, span: items.CrossItem(
            b.ident(parts[1]), parts[2], tuple(parts[3:]), span
        ),
        "steps": lambda _, parts, span: items.StepsSyntax(tuple(parts[::2]), span),
        "sampled": lambda _, parts, span: items.SampledClause(parts[1], span),
        "count": lambda b, parts, span: items.CountClause(
            str(parts[0]), b.number(span, parts[1:]), span
        ),
        "unwanted": lambda _, parts, span: items.UnwantedClause(
            BinKind(str(parts[0])), parts[1], span
        ),
    }

    def header(self, meta: Meta, children: Children) -> items.Header:
        title = _string(children[2]) if len(children) > 2 else ""
        return items.Header(self.ident(children[1]), title, self.span(meta))

    def real_type(self, meta: Meta, children: Children) -> items.TypeSyntax:
        units = [child.strip() for child in children if child.type == "UNIT"]
        return items.TypeSyntax("real", units[0] if units else "", (), self.span(meta))

    def signals(self, meta: Meta, children: Children) -> items.SignalItem:
        _, names, type_, *rest = children
        role = first_of([part for part in rest if isinstance(part, Role)])
        ignored = first_of([part for part in rest if isinstance(part, Span)])
        stale = first_of([part for part in rest if not isinstance(part, Role | Span)])
        return items.SignalItem(names, type_, role, ignored, stale, self.span(meta))

    def events(self, meta: Meta, children: Children) -> items.EventItem:
        role = first_of(_of(Role, children))
        return items.EventItem(tuple(_of(items.EventSyntax, children)), role, self.span(meta))

    def requirement(self, meta: Meta, children: Children) -> items.RequirementItem:
        _, name, *rest = children
        text = _string(rest.pop(0)) if isinstance(rest[0], Token) else ""
        (body, early), *clauses = rest
        clauses = [*early, *clauses]
        return items.RequirementItem(self.ident(name), text, body, tuple(clauses), self.span(meta))

    def for_each(self, meta: Meta, children: Children) -> items.ForEachClause:
        token = children[2]
        field = Name(unquoted(token), self.span(token))
        return items.ForEachClause(self.ident(children[1]), field, self.span(meta))

    def run_share(self, meta: Meta, children: Children) -> items.RunShareClause:
        at_least = children[0].endswith("least")
        return items.RunShareClause(
            at_least, self.number(self.span(meta), children[1:]), self.span(meta)
        )

    # Goals.

    def bin(self, meta: Meta, children: Children) -> items.BinSyntax:
        kinds = [BinKind(str(t)) for t in _of(Token, children) if t.type == "UNWANTED"]
        names = [token for token in _of(Token, children) if token.type == "NAME"]
        values = first_of([child for child in children if not isinstance(child, Token)])
        kind = kinds[0] if kinds else BinKind.GOAL
        return items.BinSyntax(self.ident(names[0]), values, kind, self.span(meta))

    def coverpoint(self, meta: Meta, children: Children) -> items.CoverpointItem:
        _, name, *rest = children
        bins = tuple(_of(items.BinSyntax, rest))
        expression = None if isinstance(rest[0], items.BinSyntax) else rest[0]
        clauses = tuple(rest[len(bins) + (expression is not None) :])
        return items.CoverpointItem(self.ident(name), expression, bins, clauses, self.span(meta))


def _triggered(mode: Mode, children: Children) -> tuple[items.Triggered, Children]:
    """A trigger with what is required, and the clauses between the two."""
    _, trigger, *clauses, _, consequent = children
    return items.Triggered(mode, trigger, consequent), clauses


def _of(kind: type[_T], children: Iterable[Any]) -> list[_T]:
    return [child for child in children if isinstance(child, kind)]


def _string(token: Token) -> str:
    """The text of a string, or a name as it is."""
    if not token.startswith('"'):
        return unquoted(token)
    return re.sub(r"\\(.)", r"\1", token[1:-1])
