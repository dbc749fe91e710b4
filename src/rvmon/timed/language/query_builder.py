"""The parser's tree to the types of `syntax`: the rules of queries."""

# ruff: noqa: D102 - the methods are the grammar's rules, called with one signature

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from lark import v_args
from lark.tree import Meta

from rvmon.diagnostics import Span
from rvmon.timed.language import syntax
from rvmon.timed.language.statement_builder import Maker, StatementBuilder, is_rule
from rvmon.timed.model.operators import BinaryOp, PathOp, UnaryOp
from rvmon.timed.model.rules import model_error

_CTL = {
    "EF": PathOp.POSSIBLY,
    "AG": PathOp.INVARIANTLY,
    "AF": PathOp.EVENTUALLY,
    "EG": PathOp.POTENTIALLY_ALWAYS,
    "EX": PathOp.SOME_NEXT,
    "AX": PathOp.EVERY_NEXT,
    "G": PathOp.GLOBALLY,
    "[]": PathOp.GLOBALLY,
    "F": PathOp.FINALLY,
    "<>": PathOp.FINALLY,
}


@v_args(meta=True)
class QueryBuilder(StatementBuilder):
    """One method per rule; `place` maps offsets of the text to spans."""

    makers: ClassVar[Mapping[str, Maker]] = {
        **StatementBuilder.makers,
        "within": lambda items, _: (items[0], items[1] if len(items) > 1 else None),
        "assuming": lambda items, span: syntax.Assuming(items[0], items[1], span),
    }

    def path(self, meta: Meta, items: Sequence[Any]) -> syntax.Path:
        word, *bound, body = items
        return syntax.Path(PathOp(word), body, bound[0] if bound else None, self._span(meta))

    def path_prefix(self, meta: Meta, items: Sequence[Any]) -> syntax.Path:
        word, *bound, body = items
        return syntax.Path(_CTL[word], body, bound[0] if bound else None, self._span(meta))

    def until(self, meta: Meta, items: Sequence[Any]) -> syntax.Path:
        quantifier, left, word, *bound, right = items
        span = self._span(meta)
        ops = {"A": PathOp.EVENTUALLY, "E": PathOp.POSSIBLY}
        if not isinstance(quantifier, syntax.Name) or quantifier.name not in ops:
            raise model_error("TA001", "`U` without A or E", span, "write A[p U q] or E[p U q]")
        weak = PathOp.INVARIANTLY if quantifier.name == "A" else PathOp.POTENTIALLY_ALWAYS
        limit = bound[0] if bound else None
        return _until((ops[quantifier.name], weak), left, word, right, span, limit)

    def linear_until(self, meta: Meta, items: Sequence[Any]) -> syntax.Path:
        left, word, right = items
        return _until((PathOp.FINALLY, PathOp.GLOBALLY), left, word, right, self._span(meta))

    def call_until(self, meta: Meta, items: Sequence[Any]) -> syntax.Call:
        name, *parts = items
        return syntax.Call(str(name), (self.linear_until(meta, parts),), self._span(meta))

    def chance(self, meta: Meta, items: Sequence[Any]) -> syntax.Chance:
        name, (within, runs), word, body, *test = items
        span = self._span(meta)
        sign, level = (BinaryOp(test[0]), float(test[1])) if test else (None, 0.0)
        if not isinstance(name, syntax.Name) or name.name != "Pr":
            raise model_error("TA001", "a bound in runs", span, "write Pr[<=T](<> p)")
        if test and (sign not in (BinaryOp.GE, BinaryOp.LE) or not 0 < level < 1):
            fix = "a probability is >= or <= a number above 0 and below 1"
            raise model_error("TA020", "this is no test", span, fix)
        return syntax.Chance(_CTL[word], body, within, runs, sign, level, span)

    def mean(self, meta: Meta, items: Sequence[Any]) -> syntax.Mean:
        name, (within, runs), which, value = items
        span = self._span(meta)
        if not isinstance(name, syntax.Name) or name.name != "E" or which not in ("max", "min"):
            fix = "write E[<=T; n](max: e) or (min: e)"
            raise model_error("TA001", "this is no expected value", span, fix)
        return syntax.Mean(which == "max", value, within, runs, span)

    def simulation(self, meta: Meta, items: Sequence[Any]) -> syntax.Simulation:
        _, *number, (within, runs) = items[: 2 + isinstance(items[1], str)]
        span = self._span(meta)
        if number:
            runs = syntax.Number(int(number[0]), span)
        return syntax.Simulation(tuple(items[2 + len(number) :]), within, runs, span)

    def extremes(self, meta: Meta, items: Sequence[Any]) -> syntax.Extremes:
        word, *terms = items
        ends = {"sup": (True,), "inf": (False,), "bounds": (False, True)}[word]
        where = terms.pop(0).children[0] if is_rule(terms[0], "where") else None
        return syntax.Extremes(ends, where, tuple(terms), self._span(meta))

    def leads_to(self, meta: Meta, items: Sequence[Any]) -> syntax.LeadsTo:
        left, *bound, right = items
        return syntax.LeadsTo(left, right, bound[0] if bound else None, self._span(meta))


def _until(
    ops: tuple[PathOp, PathOp],
    left: syntax.Expression,
    word: str,
    right: syntax.Expression,
    span: Span,
    bound: syntax.Expression | None = None,
) -> syntax.Path:
    """`left U right`, or `left W right`: never both of them false before the right one holds."""
    if word == "U":
        return syntax.Path(ops[0], right, bound, span, left)
    stays = syntax.Binary(BinaryOp.OR, left, right, span)
    return syntax.Path(ops[1], stays, bound, span, syntax.Unary(UnaryOp.NOT, right, span))
