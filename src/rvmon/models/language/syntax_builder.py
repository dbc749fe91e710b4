"""Builds the types of `syntax` from the parse tree: the document, declarations, expressions."""

# ruff: noqa: ARG002, D102 - the methods are the grammar's rules, called with one signature

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any, ClassVar

from lark import Token, Tree, v_args
from lark.tree import Meta
from msgspec.structs import replace

from rvmon.models import model_error
from rvmon.models.language import automaton_syntax, syntax
from rvmon.models.language.automaton_syntax import SignalText
from rvmon.models.language.statement_builder import Maker, QueryBuilder, is_rule
from rvmon.models.language.syntax import TypeText
from rvmon.models.network.expressions import BaseType, BinaryOp, LocationKind, UnaryOp
from rvmon.trace.time import TICKS_PER_UNIT

LARGEST = (1 << 31) - 1  # the largest number that a model may contain, as in UPPAAL


@v_args(meta=True)
class SyntaxBuilder(QueryBuilder):
    """Has a method or a maker per rule of the grammar; `place` maps offsets to spans."""

    makers: ClassVar[Mapping[str, Maker]] = {
        **QueryBuilder.makers,
        **dict.fromkeys(
            ("instances", "parameters", "selections", "arguments"), lambda items, _: tuple(items)
        ),
        "system": lambda items, _: (
            _all(items, syntax.Declared),
            _all(items, automaton_syntax.Instance),
            tuple(items[-1].children),
        ),
        "declarations": lambda items, _: _all(items, syntax.Declared),
        "values": lambda items, span: syntax.Values(tuple(items), span),
        "priorities": lambda items, span: syntax.PrioritiesText(
            tuple(map(tuple, _levels(items))), span
        ),
        "prefix": lambda items, _: str(items[0]),
        "plain_type": lambda items, span: TypeText(BaseType(items[0]), span),
        "int_type": lambda items, span: TypeText(BaseType.INT, span, *items),
        "record_type": lambda items, span: TypeText(
            BaseType.RECORD, span, fields=_all(items, syntax.Declaration)
        ),
        "named_type": lambda items, span: TypeText(BaseType.NAMED, span, name=str(items[0])),
        "selection": lambda items, span: automaton_syntax.Selection(str(items[0]), items[1], span),
        "imply": lambda items, span: syntax.Binary(BinaryOp.IMPLY, items[0], items[-1], span),
        "either": lambda items, span: syntax.Binary(BinaryOp.OR, items[0], items[-1], span),
        "both": lambda items, span: syntax.Binary(BinaryOp.AND, items[0], items[-1], span),
        "binary": lambda items, span: syntax.Binary(BinaryOp(items[1]), items[0], items[-1], span),
        "negation": lambda items, span: syntax.Unary(UnaryOp.NOT, items[0], span),
        "invert": lambda items, span: syntax.Unary(UnaryOp.INVERT, items[-1], span),
        "positive": lambda items, _: items[-1],
        "negative": lambda items, span: syntax.Unary(UnaryOp.NEGATE, items[-1], span),
        "conditional": lambda items, span: syntax.Conditional(items[0], items[1], items[2], span),
        "decimal": lambda items, span: syntax.Decimal(float(items[0]), span),
        "truth": lambda items, span: syntax.Number(int(items[0] == "true"), span),
        "index": lambda items, span: syntax.Index(items[0], items[1], span),
        "member": lambda items, span: syntax.Member(items[0], str(items[1]), span),
        "rate": lambda items, span: syntax.Rate(items[0], span),
        "call": lambda items, span: syntax.Call(str(items[0]), items[1], span),
    }

    # The document.

    def document(self, meta: Meta, items: Sequence[Any]) -> tuple[Any, ...]:
        header, unit, system = ("model", ""), None, None
        for item in items:
            match item:
                case Tree(data="header", children=[name]):
                    header = (str(name), "")
                case Tree(data="header", children=[name, title]):
                    header = (str(name), str(title)[1:-1])
                case Tree(data="unit", children=[ticks]):
                    unit = ticks
                case Tree(data="system_line", children=names):
                    system = tuple(names)
        return (
            *header,
            unit,
            _all(items, syntax.Declared),
            _all(items, automaton_syntax.Template),
            _all(items, automaton_syntax.Instance),
            system,
            _all(items, automaton_syntax.QueryText),
            _all(items, SignalText),
        )

    def unit(self, meta: Meta, items: Sequence[Token]) -> Tree[int]:
        number, unit = self._whole(items[0]), items[1]
        if unit not in TICKS_PER_UNIT or number == 0:
            fix = "write a whole number above 0 of " + ", ".join(TICKS_PER_UNIT)
            raise model_error("TA001", "this is not a unit of time", self._span(meta), fix)
        return Tree("unit", [number * TICKS_PER_UNIT[unit]])

    def system_line(self, meta: Meta, items: Sequence[Token]) -> Tree[tuple[syntax.Name, int]]:
        ranked = enumerate(_levels(item for item in items if item.type in ("NAME", "LESS")))
        return Tree("system_line", [(self._name(n), rank) for rank, names in ranked for n in names])

    def query_item(self, meta: Meta, items: Sequence[Any]) -> automaton_syntax.QueryText:
        *head, formula = items
        identifier = next((h.children[0] for h in head if isinstance(h, Tree)), "")
        remark = next((h[1:-1] for h in head if isinstance(h, Token)), "")
        text = formula.span.text
        return automaton_syntax.QueryText(str(identifier), remark, text, formula, self._span(meta))

    def signal_item(self, meta: Meta, items: Sequence[Any]) -> SignalText:
        return SignalText(str(items[0]), items[1], self._token_span(items[0]))

    # Automata.

    def automaton(self, meta: Meta, items: Sequence[Any]) -> automaton_syntax.Template:
        name, *rest = items
        parameters: tuple[syntax.Parameter, ...] = ()
        if rest and isinstance(rest[0], tuple):
            parameters, *rest = rest
        starts: list[syntax.Name] = [i.children[0] for i in rest if is_rule(i, "initial")]
        for second in starts[1:]:
            raise model_error("TA003", "a second initial location", second.span)
        return automaton_syntax.Template(
            str(name), parameters, _all(rest, syntax.Declared),
            _all(rest, automaton_syntax.LocationText), starts[0] if starts else None,
            _all(rest, automaton_syntax.EdgeText), self._token_span(name),
        )  # fmt: skip

    def initial(self, meta: Meta, items: Sequence[Token]) -> Tree[syntax.Name]:
        return Tree("initial", [self._name(items[0])])

    def location(self, meta: Meta, items: Sequence[Any]) -> automaton_syntax.LocationText:
        kind = LocationKind.NORMAL
        if items[0].type in ("URGENT", "COMMITTED"):
            kind, *items = LocationKind(items[0]), *items[1:]
        name, *rest = items
        leaving = rest.pop() if rest and isinstance(rest[-1], tuple) else None
        invariant = rest[0] if rest else None
        span = self._token_span(name)
        return automaton_syntax.LocationText(str(name), kind, invariant, span, leaving)

    def edge(self, meta: Meta, items: Sequence[Any]) -> automaton_syntax.EdgeText:
        source, target, *clauses = items
        parts: dict[str, Any] = {}
        for clause in clauses:
            if clause.data in parts:
                message = f"two `{clause.data}` clauses on one edge"
                raise model_error("TA003", message, self._span(meta))
            parts[clause.data] = clause.children[0]
        return automaton_syntax.EdgeText(
            self._name(source), self._name(target), self._span(meta),
            parts.get("select", ()), parts.get("when"), parts.get("on"), parts.get("do", ()),
            parts.get("weight", 1.0), str(parts.get("as", "")).strip('"'),
        )  # fmt: skip

    def weight(self, meta: Meta, items: Sequence[Token]) -> Tree[float]:
        weight = float(items[0])
        if not 0 < weight <= 1:
            fix = "a weight is a share: above 0, at most 1"
            raise model_error("TA017", f"weight {items[0]}", self._span(meta), fix)
        return Tree("weight", [weight])

    def instance(self, meta: Meta, items: Sequence[Any]) -> automaton_syntax.Instance:
        name, *parameters, template, arguments = items
        return automaton_syntax.Instance(
            str(name), parameters[0] if parameters else (), self._name(template), arguments,
            self._token_span(name),
        )  # fmt: skip

    # Declarations.

    def declaration(self, meta: Meta, items: Sequence[Any]) -> Tree[syntax.Declaration]:
        kind, *declarators = items
        return Tree(
            "declaration",
            [syntax.Declaration(kind, name, sizes, initial, span)
             for name, sizes, initial, span in declarators],
        )  # fmt: skip

    def declarator(self, meta: Meta, items: Sequence[Any]) -> tuple[Any, ...]:
        name, *rest = items
        sizes = tuple(item.children[0] for item in rest if isinstance(item, Tree))
        initial = rest[-1] if rest and not isinstance(rest[-1], Tree) else None
        return str(name), sizes, initial, self._token_span(name)

    def typedef(self, meta: Meta, items: Sequence[Any]) -> syntax.TypeDefinition:
        kind, name, *sizes = items
        extents = tuple(size.children[0] for size in sizes)
        return syntax.TypeDefinition(str(name), kind, extents, self._token_span(name))

    def type(self, meta: Meta, items: Sequence[Any]) -> TypeText:
        *prefixes, base = items
        marks = {word: word in prefixes for word in ("const", "broadcast", "urgent")}
        made: TypeText = replace(base, span=self._span(meta), **marks)
        return made

    def scalar_type(self, meta: Meta, items: Sequence[Any]) -> TypeText:
        # A scalar set is symmetric, so numbering its values changes no answer.
        span = self._span(meta)
        low, one = syntax.Number(0, span), syntax.Number(1, span)
        return TypeText(BaseType.INT, span, low, syntax.Binary(BinaryOp.SUB, items[0], one, span))

    def parameter(self, meta: Meta, items: Sequence[Any]) -> syntax.Parameter:
        kind, *rest = items
        reference = is_rule(rest[0], "reference")
        name, *sizes = rest[1:] if reference else rest
        return syntax.Parameter(
            kind, str(name), tuple(size.children[0] for size in sizes), reference,
            self._token_span(name),
        )  # fmt: skip

    # Expressions.

    def quantified(self, meta: Meta, items: Sequence[Any]) -> syntax.Quantified:
        word, name, kind, body = items
        op = {"forall": BinaryOp.AND, "exists": BinaryOp.OR, "sum": BinaryOp.ADD}[word]
        return syntax.Quantified(op, str(name), kind, body, self._span(meta))

    def number(self, meta: Meta, items: Sequence[Token]) -> syntax.Number:
        return syntax.Number(self._whole(items[0]), self._span(meta))

    def _whole(self, token: Token) -> int:
        # Check the length first: Python refuses to convert numbers with thousands of digits.
        if len(token.lstrip("0")) > len(str(LARGEST)) or int(token) > LARGEST:
            fix = f"numbers go up to {LARGEST:,}"
            raise model_error("TA007", "the number is too large", self._token_span(token), fix)
        return int(token)

    def name(self, meta: Meta, items: Sequence[Token]) -> syntax.Name:
        return self._name(items[0])

    def leaving(self, meta: Meta, items: Sequence[Any]) -> tuple[Any, Any]:
        shares = [*items, syntax.Number(1, self._span(meta))][:2]
        if not any(isinstance(share, syntax.Decimal) for share in shares):
            return shares[0], shares[1]
        span = self._span(meta)
        if not all(isinstance(share, syntax.Decimal | syntax.Number) for share in shares):
            fix = "write whole numbers as a share, such as 1:20"
            raise model_error("TA017", "this is not a rate", span, fix)
        # A share of decimals becomes one of integers.
        one, other = (Fraction(str(share.value)) for share in shares)
        rate = one / other if other else Fraction(0)
        return syntax.Number(rate.numerator, span), syntax.Number(rate.denominator, span)


def _levels(items: Iterable[Any]) -> list[list[Any]]:
    """Split the items at the signs `<`."""
    levels: list[list[Any]] = [[]]
    for item in items:
        if item == "<":
            levels.append([])
        else:
            levels[-1].append(item)
    return levels


def _all(items: Sequence[Any], kind: Any) -> tuple[Any, ...]:
    """All items of a kind. The declarators of a declaration are inside a tree of their own."""
    flat: list[Any] = []
    for item in items:
        flat += item.children if is_rule(item, "declaration") else [item]
    return tuple(item for item in flat if isinstance(item, kind))
