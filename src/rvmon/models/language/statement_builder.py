"""Builds the types of `syntax` from the parse tree: functions, labels of edges, and queries."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

from lark import Token, Transformer, Tree, v_args
from lark.tree import Meta

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models.language import automaton_syntax, syntax
from rvmon.models.network.expressions import BinaryOp, PathOp, UnaryOp

# ruff: noqa: ARG002, D102 - the methods are the grammar's rules, called with one signature


Maker = Callable[[Sequence[Any], Span], Any]  # makes the value of a rule from its parts and span


@v_args(meta=True)
class StatementBuilder(Transformer[Token, Any]):
    """Has a maker or a method per rule of the grammar; `place` maps offsets to spans."""

    makers: ClassVar[Mapping[str, Maker]] = {
        "block": lambda items, span: syntax.Block(_statements(items), span),
        "branch": lambda items, span: syntax.Branch(
            items[0], _statements(items[1:2]), _statements(items[2:]), span
        ),
        "each": lambda items, span: syntax.Each(
            str(items[0]), items[1], _statements(items[2:]), span
        ),
        "perform": lambda items, _: items[0],
        "nothing": lambda *_: (),
        "loop": lambda items, span: syntax.Loop(items[0], _statements(items[1:]), span),
        "return_": lambda items, span: syntax.ReturnText(items[0] if items else None, span),
        "sync": lambda items, span: automaton_syntax.SyncText(items[0], items[1] == "!", span),
        "updates": lambda items, _: tuple(items[0]) if items else (),
        "update_list": lambda items, _: _statements(items),
        "call_update": lambda items, span: syntax.Call(str(items[0]), items[1], span),
    }

    def __init__(self, place: Callable[[int, int], Span]) -> None:
        super().__init__()
        self._place = place

    def __default__(self, data: str, children: list[Any], meta: Meta) -> Any:
        make = self.makers.get(data)
        return Tree(data, children) if make is None else make(children, self._span(meta))

    def _span(self, meta: Meta) -> Span:
        return self._place(0, 0) if meta.empty else self._place(meta.start_pos, meta.end_pos)

    def _token_span(self, token: Token) -> Span:
        return self._place(token.start_pos or 0, token.end_pos or 0)

    def _name(self, token: Token) -> syntax.Name:
        return syntax.Name(str(token), self._token_span(token))

    # Functions.

    def function(self, meta: Meta, items: Sequence[Any]) -> syntax.FunctionText:
        *kind, name, parameters, body = items
        result = kind[0] if kind else None
        return syntax.FunctionText(result, str(name), parameters, body, self._token_span(name))

    def do_while(self, meta: Meta, items: Sequence[Any]) -> syntax.Block:
        span, body = self._span(meta), _statements(items[:1])
        return syntax.Block((*body, syntax.Loop(items[1], body, span)), span)

    def counting(self, meta: Meta, items: Sequence[Any]) -> syntax.Block:
        span = self._span(meta)
        place = next(i for i, item in enumerate(items) if not isinstance(item, tuple))
        body = _statements([items[-1], *items[place + 1 : -1]])
        loop = syntax.Loop(items[place], body, span)
        return syntax.Block((*_statements(items[:place]), loop), span)

    # Labels.

    def conditions(self, meta: Meta, items: Sequence[Any]) -> Any:
        joined, *rest = items
        for one in rest:
            joined = syntax.Binary(BinaryOp.AND, joined, one, self._span(meta))
        return joined

    def assign(self, meta: Meta, items: Sequence[Any]) -> Any:
        target, sign, value = items
        span = self._span(meta)
        before: tuple[syntax.Statement, ...] = ()
        after: tuple[syntax.Statement, ...] = ()
        if is_rule(target, "stepped"):  # a[i++] = v: i is incremented afterwards
            base, index, step = target.children
            target, after = syntax.Index(base, index, span), (self.step(meta, (index, step)),)
        if isinstance(value, tuple):  # a = b = c: first sets b, then sets a to the new value of b
            before, value = value, value[-1].target
        elif isinstance(value, syntax.UpdateText):
            before, value = (value,), value.target
        if sign not in (":=", "="):
            value = syntax.Binary(BinaryOp(sign[:-1]), target, value, span)
        update = syntax.UpdateText(target, value, span)
        return (*before, update, *after) if before or after else update

    def step(self, meta: Meta, items: Sequence[Any]) -> syntax.UpdateText:
        target, sign = items if items[1] in ("++", "--") else reversed(items)
        span = self._span(meta)
        value = syntax.Binary(BinaryOp(sign[0]), target, syntax.Number(1, span), span)
        return syntax.UpdateText(target, value, span)


def _statements(items: Sequence[Any]) -> tuple[syntax.Statement, ...]:
    """Flatten items to statements. Updates and declarators are inside lists of their own."""
    flat: list[syntax.Statement] = []
    for item in items:
        if is_rule(item, "declaration"):
            flat += item.children
        elif isinstance(item, tuple):
            flat += item
        else:
            flat.append(item)
    return tuple(flat)


def is_rule(item: object, rule: str) -> bool:
    """Whether an item is the tree of a rule."""
    return isinstance(item, Tree) and item.data == rule


_CTL = {
    "EF": PathOp.POSSIBLY, "AG": PathOp.INVARIANTLY, "AF": PathOp.EVENTUALLY,
    "EG": PathOp.POTENTIALLY_ALWAYS, "EX": PathOp.SOME_NEXT, "AX": PathOp.EVERY_NEXT,
    "G": PathOp.GLOBALLY, "[]": PathOp.GLOBALLY, "F": PathOp.FINALLY, "<>": PathOp.FINALLY,
}  # fmt: skip


@v_args(meta=True)
class QueryBuilder(StatementBuilder):
    """Adds the rules of queries."""

    makers: ClassVar[Mapping[str, Maker]] = {
        **StatementBuilder.makers,
        "within": lambda items, _: (items[0], items[1] if len(items) > 1 else None),
        "path": lambda items, span: syntax.Path(PathOp(items[0]), items[-1], _bound(items), span),
        "path_prefix": lambda items, span: syntax.Path(
            _CTL[items[0]], items[-1], _bound(items), span
        ),
        "leads_to": lambda items, span: syntax.LeadsTo(items[0], items[-1], _bound(items), span),
        "assuming": lambda items, span: syntax.Assuming(items[0], items[1], span),
    }

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
            raise model_error("TA020", "this is not a test", span, fix)
        return syntax.Chance(_CTL[word], body, within, runs, sign, level, span)

    def mean(self, meta: Meta, items: Sequence[Any]) -> syntax.Mean:
        name, (within, runs), which, value = items
        span = self._span(meta)
        if not isinstance(name, syntax.Name) or name.name != "E" or which not in ("max", "min"):
            fix = "write E[<=T; n](max: e) or (min: e)"
            raise model_error("TA001", "this is not an expected value", span, fix)
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


def _bound(items: Sequence[Any]) -> Any:
    """The bound between the first and the last item, if there is one."""
    return items[1] if len(items) > 2 else None


def _until(
    ops: tuple[PathOp, PathOp],
    left: syntax.Expression,
    word: str,
    right: syntax.Expression,
    span: Span,
    bound: syntax.Expression | None = None,
) -> syntax.Path:
    """`left U right`, or `left W right`, by which `left` may also hold forever."""
    if word == "U":
        return syntax.Path(ops[0], right, bound, span, left)
    # `p W q`: p or q holds up to and including the first state with q.
    stays = syntax.Binary(BinaryOp.OR, left, right, span)
    return syntax.Path(ops[1], stays, bound, span, syntax.Unary(UnaryOp.NOT, right, span))
