# ruff: noqa: D102, ARG002 - each method is named for a rule of the grammar
"""From the parser's tree of an item to the syntax tree."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any, ClassVar, TypeVar

from lark import Token
from lark.tree import Meta
from lark.visitors import Transformer_NonRecursive, v_args

from rvmon.diagnostics import Diagnostic, Source, Span
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.formula import BinaryOp, Bound, CompareOp, UnaryOp
from rvmon.language.checked.properties import BinKind
from rvmon.language.checked.specification import Mode, Role, TimeModel
from rvmon.language.rules import Refusal, short
from rvmon.language.rules import syntax as rules
from rvmon.language.syntax import expressions, items

_T = TypeVar("_T")
_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")
_LARGEST = 400
"""Numbers with more digits before the point, or more zeros behind it, are out of range."""

Children = list[Any]
Maker = Callable[[Any, Children, Span], Any]
"""Makes what a rule reads, of the builder, the rule's parts and its place."""


@v_args(meta=True)
class Builder(Transformer_NonRecursive[Token, Any]):
    """Makes the syntax tree of one item; a maker or a method for each rule of `rv.lark`.

    Args:
        source: the file.
        offset: the start in it of the text given to the parser.

    Attributes:
        findings: on the syntax of the item.
    """

    makers: ClassVar[Mapping[str, Maker]] = {
        "literal": lambda b, parts, span: b.number(span, parts),
        "name": lambda _, parts, span: expressions.Name(unquoted(parts[0]), span),
        "truth": lambda _, parts, span: expressions.Truth(parts[0] == "true", span),
        "edge": lambda _, parts, span: expressions.Edge(Bound(parts[0]), span),
        "group": lambda _, parts, span: expressions.Group(parts[0], span),
        "minus": lambda _, parts, span: expressions.Operation(NumericOp.NEG, (parts[1],), span),
        "arithmetic": lambda _, parts, span: expressions.Operation(
            NumericOp.of(str(parts[1])), (parts[0], parts[2]), span
        ),
        "call": lambda b, parts, span: expressions.Call(b.called(parts[0]), tuple(parts[1:]), span),
        "choice": lambda _, parts, span: expressions.Choice(parts[1], parts[3], parts[5], span),
        "quantified": lambda _, parts, span: expressions.Quantified(
            parts[0] == "A", parts[1], span
        ),
        "leads_to": lambda _, parts, span: expressions.LeadsTo(
            parts[0], parts[-1], first_of(parts[2:-1]), span
        ),
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

    def __init__(self, source: Source, offset: int) -> None:
        super().__init__()
        self.findings: list[Diagnostic] = []
        self._source = source
        self._offset = offset

    def __default__(self, data: str, children: Children, meta: Meta) -> Any:
        return self.makers[data](self, children, self.span(meta))

    def span(self, place: Meta | Token) -> Span:
        """The place of a token or rule in the file."""
        if isinstance(place, Token):
            start, end = place.start_pos or 0, place.end_pos or 0
        else:
            start, end = place.start_pos, place.end_pos
        return Span(self._source, self._offset + start, self._offset + end)

    def ident(self, token: Token) -> expressions.Ident:
        """A name with its place."""
        return expressions.Ident(unquoted(token), self.span(token))

    def called(self, token: Token) -> expressions.Ident:
        """The name in a token that ends with its bracket."""
        span = self.span(token)
        return expressions.Ident(token[:-1], Span(span.source, span.start, span.end - 1))

    def number(self, span: Span, children: Children) -> expressions.Number:
        """A number with its unit."""
        text = str(children[0])
        digits = text[: _NUMBER.match(text).end()]  # type: ignore[union-attr]  # terminal NUMBER
        decimal = Decimal(digits)
        # As a fraction, `1e999999999` would take half a gigabyte.
        small = abs(decimal.adjusted()) <= _LARGEST and len(digits) <= 2 * _LARGEST
        value = Fraction(decimal) if small or not decimal else None
        return expressions.Number(value, text[len(digits) :].strip(), span)

    def comparison(self, meta: Meta, children: Children) -> expressions.Comparison:
        if len(children) > 3:
            left, first, middle, second, right, *_ = children
            raise Refusal(rules.comparison_chain(left.span, first, middle.span, second, right.span))
        left, op, right = children
        compare = CompareOp("==" if op == "=" else str(op))
        return expressions.Comparison(compare, left, right, self.span(op), self.span(meta))

    def among(self, meta: Meta, children: Children) -> expressions.Expression:
        left, *values = (child for child in children if not isinstance(child, Token))
        span = self.span(meta)
        equal = [
            expressions.Comparison(CompareOp.EQ, left, value, value.span, span) for value in values
        ]
        either: expressions.Expression = equal[0]
        for further in equal[1:]:
            either = expressions.Infix(BinaryOp.OR, either, further, None, span, span)
        either = expressions.Group(either, span)
        denied = any(isinstance(child, Token) for child in children)
        return expressions.Prefix(UnaryOp.NOT, either, None, span, span) if denied else either

    def prefix(
        self, meta: Meta, children: Children
    ) -> expressions.Prefix | expressions.Immediately:
        token, *window, operand = children
        if token.type == "IMMEDIATELY":
            return expressions.Immediately(operand, self.span(meta))
        op = UnaryOp.of(token)
        return expressions.Prefix(op, operand, first_of(window), self.span(token), self.span(meta))

    def bounded(self, meta: Meta, children: Children) -> expressions.Prefix:
        token, bound, operand = children
        op = UnaryOp.EVENTUALLY if token.type == "WITHIN" else UnaryOp.ALWAYS
        if isinstance(bound, expressions.Window):
            return expressions.Prefix(op, operand, bound, self.span(token), self.span(meta))
        window = expressions.Window(None, bound, False, False, bound.span)
        return expressions.Prefix(op, operand, window, self.span(token), self.span(meta))

    def chain(self, meta: Meta, children: Children) -> expressions.Infix:
        operands, tokens = children[::2], children[1::2]
        if not _are_alike(operands):
            for operand in operands[:-1]:
                self._check_reach(operand, operands[-1])
        if tokens[0].type != "IFF":
            self._check_sides(operands, tokens)
        infix: expressions.Infix = self._balanced(operands, tokens)
        return infix

    def _balanced(self, operands: Sequence[Any], tokens: Sequence[Token]) -> Any:
        """All four connectives are associative, so a long chain need not become a deep tree."""
        if len(operands) == 1:
            return operands[0]
        middle = (len(operands) + 1) // 2
        left = self._balanced(operands[:middle], tokens[: middle - 1])
        right = self._balanced(operands[middle:], tokens[middle:])
        token = tokens[middle - 1]
        span = left.span.to(right.span)
        return expressions.Infix(BinaryOp.of(token), left, right, None, self.span(token), span)

    def infix(self, meta: Meta, children: Children) -> expressions.Infix:
        left, token, *window, right = children
        op = BinaryOp.of(" ".join(token.split()))
        self._check_reach(left, right)
        if token.type == "INFIX" and isinstance(right, expressions.Infix) and right.op is not op:
            first = self.span(token)
            self.findings.append(rules.mixed_chain(right.op_span, first, short(first.text)))
        return expressions.Infix(
            op, left, right, first_of(window), self.span(token), self.span(meta)
        )

    def _check_sides(self, operands: Sequence[Any], tokens: Sequence[Token]) -> None:
        """Between `until` or its kin and a connective a reader may see the other bracket first."""
        for number, operand in enumerate(operands):
            if (
                isinstance(operand, expressions.Infix)
                and operand.op.entry.level == BinaryOp.UNTIL.entry.level
            ):
                token = tokens[min(number, len(tokens) - 1)]
                near = operand.right if number < len(tokens) else operand.left
                self.findings.append(
                    rules.two_sides(operand.span, operand.op_span, self.span(token), near.span)
                )

    def _check_reach(self, left: expressions.Expression, last: expressions.Expression) -> None:
        """A temporal prefix right before a connective has to say how far it reaches."""
        edge = left
        while True:
            match edge:
                case (
                    expressions.Prefix(op=UnaryOp.NOT, operand=inner)
                    | expressions.Infix(right=inner)
                ):
                    edge = inner
                case expressions.Prefix() | expressions.Path(reaching=False):
                    break
                case _:
                    return
        if not isinstance(edge.operand, expressions.Group):
            operand = edge.operand.span
            operator = Span(operand.source, edge.span.start, operand.start)
            self.findings.append(rules.reach(operator, operand, last.span))

    def path(self, meta: Meta, children: Children) -> expressions.Path:
        token, *window, operand = children
        reaching = token.type == "PATH"
        if reaching:
            op = UnaryOp.ALWAYS if token[1] == "[" else UnaryOp.EVENTUALLY
        else:
            op = UnaryOp.of(token[1])
        spans = self.span(token), self.span(meta)
        return expressions.Path(token[0] == "A", op, operand, first_of(window), reaching, *spans)

    def at_most(self, meta: Meta, children: Children) -> expressions.Window:
        (bound,) = (child for child in children if not isinstance(child, Token))
        return expressions.Window(None, bound, False, False, self.span(meta))

    def window(self, meta: Meta, children: Children) -> expressions.Window:
        opening, low, high, closing = children
        endless = isinstance(high, Token)
        return expressions.Window(
            low, None if endless else high, opening == "(", closing == ")", self.span(meta)
        )

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
        field = expressions.Name(unquoted(token), self.span(token))
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


def _are_alike(operands: Sequence[Any]) -> bool:
    """Whether all begin with the same operator of time, which nobody takes for one in the other."""
    firsts = {
        operand.op if isinstance(operand, expressions.Prefix) else None for operand in operands
    }
    return len(firsts) == 1 and not firsts & {None, UnaryOp.NOT}


def first_of(elements: Sequence[_T]) -> _T | None:
    """The first element, if there is one."""
    return elements[0] if elements else None


def unquoted(token: Token) -> str:
    """A name without its quotes."""
    return token[1:-1] if token.startswith("`") else str(token)


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
