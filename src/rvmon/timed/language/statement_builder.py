"""The parser's tree to the types of `syntax`: functions, statements and the labels of edges."""

# ruff: noqa: ARG002, D102 - the methods are the grammar's rules, called with one signature

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

from lark import Token, Transformer, Tree, v_args
from lark.tree import Meta

from rvmon.diagnostics import Span
from rvmon.timed.language import automaton_syntax, syntax
from rvmon.timed.model.operators import BinaryOp

Maker = Callable[[Sequence[Any], Span], Any]
"""Makes what a rule reads, of its parts and its place."""


@v_args(meta=True)
class StatementBuilder(Transformer[Token, Any]):
    """A maker or a method per rule of the grammar; `place` maps offsets of the text to spans."""

    makers: ClassVar[Mapping[str, Maker]] = {
        "block": lambda items, span: syntax.Block(_statements(items), span),
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

    def branch(self, meta: Meta, items: Sequence[Any]) -> syntax.Branch:
        condition, then, *otherwise = items
        return syntax.Branch(
            condition, _statements([then]), _statements(otherwise), self._span(meta)
        )

    def loop_behind(self, meta: Meta, items: Sequence[Any]) -> syntax.Block:
        span, body = self._span(meta), _statements(items[:1])
        return syntax.Block((*body, syntax.Loop(items[1], body, span)), span)

    def counting(self, meta: Meta, items: Sequence[Any]) -> syntax.Block:
        span = self._span(meta)
        place = next(i for i, one in enumerate(items) if not isinstance(one, tuple))
        body = _statements([items[-1], *items[place + 1 : -1]])
        loop = syntax.Loop(items[place], body, span)
        return syntax.Block((*_statements(items[:place]), loop), span)

    def each(self, meta: Meta, items: Sequence[Any]) -> syntax.Each:
        name, kind, body = items
        return syntax.Each(str(name), kind, _statements([body]), self._span(meta))

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
        behind: tuple[syntax.Statement, ...] = ()
        if is_rule(target, "stepped"):  # a[i++] = v: i counts on behind
            base, index, step = target.children
            target, behind = syntax.Index(base, index, span), (self.step(meta, (index, step)),)
        if isinstance(value, tuple):  # a = b = c: first b is set, then a to what b has then
            before, value = value, value[-1].target
        elif isinstance(value, syntax.UpdateText):
            before, value = (value,), value.target
        if sign not in (":=", "="):
            value = syntax.Binary(BinaryOp(sign[:-1]), target, value, span)
        update = syntax.UpdateText(target, value, span)
        return (*before, update, *behind) if before or behind else update

    def step(self, meta: Meta, items: Sequence[Any]) -> syntax.UpdateText:
        target, sign = items if items[1] in ("++", "--") else reversed(items)
        span = self._span(meta)
        value = syntax.Binary(BinaryOp(sign[0]), target, syntax.Number(1, span), span)
        return syntax.UpdateText(target, value, span)


def _statements(items: Sequence[Any]) -> tuple[syntax.Statement, ...]:
    """Statements one behind the other; updates and declarators stand in lists of their own."""
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
    """Whether something is what a rule left as a tree."""
    return isinstance(item, Tree) and item.data == rule
