"""From the parser's tree of one item to the syntax tree."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any, TypeVar

from lark import Token
from lark.tree import Meta
from lark.visitors import Transformer_NonRecursive, v_args

from rvmon.diagnostics.diagnostic import Diagnostic
from rvmon.diagnostics.span import Source, Span
from rvmon.spec.checked import (
    BinaryOp,
    Bound,
    CompareOp,
    Mode,
    NumericOp,
    Role,
    TimeModel,
    UnaryOp,
)
from rvmon.spec.rules import syntax as rules
from rvmon.spec.rules.rule import Refusal
from rvmon.spec.syntax import (
    AtEndClause,
    Bare,
    Call,
    Comparison,
    ConstItem,
    DefineItem,
    DelayItem,
    Edge,
    EventItem,
    EventSyntax,
    Expression,
    FieldSyntax,
    ForEachClause,
    Group,
    Header,
    Ident,
    Immediately,
    Infix,
    LeadsTo,
    LetClause,
    Name,
    Number,
    Operation,
    Path,
    Prefix,
    PropertyClause,
    PropertyItem,
    Quantified,
    RequirementItem,
    ResponseMonitor,
    SignalItem,
    TagsClause,
    TextClause,
    TimeItem,
    Triggered,
    Truth,
    TypeSyntax,
    Window,
)

_PREFIX = {
    "next": UnaryOp.NEXT,
    "eventually": UnaryOp.EVENTUALLY,
    "always": UnaryOp.ALWAYS,
    "previous": UnaryOp.PREVIOUS,
    "once": UnaryOp.ONCE,
    "historically": UnaryOp.HISTORICALLY,
}
_INFIX = {
    "until": BinaryOp.UNTIL,
    "since": BinaryOp.SINCE,
    "unless": BinaryOp.WEAK_UNTIL,
    "implies": BinaryOp.IMPLIES,
}
_CHAIN = {
    "AND": BinaryOp.AND,
    "OR": BinaryOp.OR,
    "XOR": BinaryOp.XOR,
    "IFF": BinaryOp.IFF,
}
_T = TypeVar("_T")
_NUMBER = re.compile(r"(\d+(?:\.\d+)?(?:[eE][+-]?\d+)?)[ \t]*(.*)", re.DOTALL)
_LARGEST = 400
"""Numbers with more digits before the point, or more zeros behind it, are out of range."""

Children = list[Any]


@v_args(meta=True)
class Builder(Transformer_NonRecursive[Token, Any]):
    """Makes the syntax tree of one item; each method is named for a rule of `rv.lark`.

    Args:
        source: the file.
        offset: where the item starts in it.

    Attributes:
        findings: what is wrong with the way the item is written.
    """

    def __init__(self, source: Source, offset: int) -> None:
        super().__init__()
        self.findings: list[Diagnostic] = []
        self._source = source
        self._offset = offset

    def _span(self, place: Meta | Token) -> Span:
        if isinstance(place, Token):
            start, end = place.start_pos or 0, place.end_pos or 0
        else:
            start, end = place.start_pos, place.end_pos
        return Span(self._source, self._offset + start, self._offset + end)

    def _ident(self, token: Token) -> Ident:
        return Ident(_unquoted(token), self._span(token))

    # Expressions.

    def number(self, meta: Meta, children: Children) -> Number:
        found = _NUMBER.match(children[0])
        assert found is not None, "the terminal NUMBER starts with a number"
        decimal = Decimal(found[1])
        small = abs(decimal.adjusted()) <= _LARGEST and len(found[1]) <= 2 * _LARGEST
        value = Fraction(decimal) if small or not decimal else None
        return Number(value, found[2], self._span(meta))

    def name(self, meta: Meta, children: Children) -> Name:
        return Name(_unquoted(children[0]), self._span(meta))

    def truth(self, meta: Meta, children: Children) -> Truth:
        return Truth(children[0] == "true", self._span(meta))

    def edge(self, meta: Meta, children: Children) -> Edge:
        return Edge(Bound(children[0]), self._span(meta))

    def call(self, meta: Meta, children: Children) -> Call:
        token, *args = children
        span = self._span(token)
        name = Ident(token[:-1], Span(span.source, span.start, span.end - 1))
        return Call(name, tuple(args), self._span(meta))

    def group(self, meta: Meta, children: Children) -> Group:
        return Group(children[0], self._span(meta))

    def minus(self, meta: Meta, children: Children) -> Operation:
        return Operation(NumericOp.NEG, (children[1],), self._span(meta))

    def arithmetic(self, meta: Meta, children: Children) -> Operation:
        left, op, right = children
        return Operation(NumericOp(str(op)), (left, right), self._span(meta))

    def comparison(self, meta: Meta, children: Children) -> Comparison:
        if len(children) > 3:
            left, first, middle, second, right, *_ = children
            raise Refusal(rules.comparison_chain(left.span, first, middle.span, second, right.span))
        left, op, right = children
        compare = CompareOp("==" if op == "=" else str(op))
        return Comparison(compare, left, right, self._span(op), self._span(meta))

    def prefix(self, meta: Meta, children: Children) -> Prefix | Immediately:
        token, *window, operand = children
        if token.type == "IMMEDIATELY":
            return Immediately(operand, self._span(meta))
        op = UnaryOp.NOT if token.type == "NOT" else _PREFIX.get(token) or UnaryOp(str(token))
        return Prefix(op, operand, _first(window), self._span(token), self._span(meta))

    def bounded(self, meta: Meta, children: Children) -> Prefix:
        token, bound, operand = children
        op = UnaryOp.EVENTUALLY if token.type == "WITHIN" else UnaryOp.ALWAYS
        window = Window(None, bound, False, False, bound.span)
        return Prefix(op, operand, window, self._span(token), self._span(meta))

    def chain(self, meta: Meta, children: Children) -> Infix:
        operands, tokens = children[::2], children[1::2]
        for operand in operands[:-1]:
            self._check_reach(operand, operands[-1])
        infix: Infix = self._balanced(operands, tokens)
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
        return Infix(_CHAIN[token.type], left, right, None, self._span(token), span)

    def infix(self, meta: Meta, children: Children) -> Infix:
        left, token, *window, right = children
        words = " ".join(token.split())
        if token.type == "IMPLIES":
            op = BinaryOp.IMPLIES
        elif words == "weak until":
            op = BinaryOp.WEAK_UNTIL
        else:
            op = _INFIX.get(words) or BinaryOp(words)
        self._check_reach(left, right)
        if token.type == "INFIX" and isinstance(right, Infix) and right.op is not op:
            self.findings.append(rules.mixed_chain(self._span(token), right.op_span))
        return Infix(op, left, right, _first(window), self._span(token), self._span(meta))

    def _check_reach(self, left: Expression, last: Expression) -> None:
        """A temporal prefix right before a connective has to say how far it reaches."""
        edge = left
        while True:
            match edge:
                case Prefix(op=UnaryOp.NOT, operand=inner) | Infix(right=inner):
                    edge = inner
                case Prefix() | Path(reaching=False):
                    break
                case _:
                    return
        if not isinstance(edge.operand, Group):
            operand = edge.operand.span
            operator = Span(operand.source, edge.span.start, operand.start)
            self.findings.append(rules.reach(operator, operand, last.span))

    def path(self, meta: Meta, children: Children) -> Path:
        token, *window, operand = children
        reaching = token.type == "PATH"
        if reaching:
            op = UnaryOp.ALWAYS if token[1] == "[" else UnaryOp.EVENTUALLY
        else:
            op = UnaryOp(token[1])
        spans = self._span(token), self._span(meta)
        return Path(token[0] == "A", op, operand, _first(window), reaching, *spans)

    def quantified(self, meta: Meta, children: Children) -> Quantified:
        token, _, path, _ = children
        return Quantified(token == "A", path, self._span(meta))

    def leads_to(self, meta: Meta, children: Children) -> LeadsTo:
        left, _, *window, right = children
        return LeadsTo(left, right, _first(window), self._span(meta))

    def at_most(self, meta: Meta, children: Children) -> Window:
        return Window(None, children[0], False, False, self._span(meta))

    def window(self, meta: Meta, children: Children) -> Window:
        opening, low, high, closing = children
        endless = isinstance(high, Token)
        return Window(
            low, None if endless else high, opening == "(", closing == ")", self._span(meta)
        )

    # Declarations.

    def header(self, meta: Meta, children: Children) -> Header:
        title = _string(children[2]) if len(children) > 2 else ""
        return Header(self._ident(children[1]), title, self._span(meta))

    def time_held(self, meta: Meta, _: Children) -> TimeItem:
        return TimeItem(TimeModel.HELD, None, self._span(meta))

    def time_sampled(self, meta: Meta, _: Children) -> TimeItem:
        return TimeItem(TimeModel.SAMPLED, None, self._span(meta))

    def time_clocked(self, meta: Meta, children: Children) -> TimeItem:
        return TimeItem(TimeModel.CLOCKED, children[-1], self._span(meta))

    def delay(self, meta: Meta, children: Children) -> DelayItem:
        return DelayItem(children[-1], self._span(meta))

    def names(self, meta: Meta, children: Children) -> tuple[Ident, ...]:
        return tuple(map(self._ident, children))

    def bool_type(self, meta: Meta, _: Children) -> TypeSyntax:
        return TypeSyntax("bool", "", (), self._span(meta))

    def int_type(self, meta: Meta, _: Children) -> TypeSyntax:
        return TypeSyntax("int", "", (), self._span(meta))

    def real_type(self, meta: Meta, children: Children) -> TypeSyntax:
        units = [child.strip() for child in children if child.type == "UNIT"]
        return TypeSyntax("real", units[0] if units else "", (), self._span(meta))

    def label_type(self, meta: Meta, children: Children) -> TypeSyntax:
        return TypeSyntax("label", "", children[0], self._span(meta))

    def role(self, meta: Meta, children: Children) -> Role:
        return Role(str(children[0]))

    def stale(self, meta: Meta, children: Children) -> Any:
        return children[1]

    def signals(self, meta: Meta, children: Children) -> SignalItem:
        _, names, type_, *rest = children
        role = _first([part for part in rest if isinstance(part, Role)])
        stale = _first([part for part in rest if not isinstance(part, Role)])
        return SignalItem(names, type_, role, stale, self._span(meta))

    def event_name(self, meta: Meta, children: Children) -> EventSyntax:
        return EventSyntax(self._ident(children[0]), ())

    def event_call(self, meta: Meta, children: Children) -> EventSyntax:
        token, *fields = children
        return EventSyntax(self._called(token), tuple(_of(FieldSyntax, fields)))

    def field(self, meta: Meta, children: Children) -> FieldSyntax:
        return FieldSyntax(self._ident(children[0]), children[1])

    def events(self, meta: Meta, children: Children) -> EventItem:
        role = _first(_of(Role, children))
        return EventItem(tuple(_of(EventSyntax, children)), role, self._span(meta))

    def define_name(self, meta: Meta, children: Children) -> DefineItem:
        return DefineItem(self._ident(children[1]), None, children[2], self._span(meta))

    def define_call(self, meta: Meta, children: Children) -> DefineItem:
        name = self._called(children[1])
        return DefineItem(name, children[2], children[-1], self._span(meta))

    def _called(self, token: Token) -> Ident:
        span = self._span(token)
        return Ident(token[:-1], Span(span.source, span.start, span.end - 1))

    def constant(self, meta: Meta, children: Children) -> ConstItem:
        return ConstItem(self._ident(children[1]), children[2], self._span(meta))

    def property(self, meta: Meta, children: Children) -> PropertyItem:
        return PropertyItem(self._ident(children[1]), children[2], self._span(meta))

    # Requirements.

    def requirement(self, meta: Meta, children: Children) -> RequirementItem:
        _, name, *rest = children
        text = _string(rest.pop(0)) if isinstance(rest[0], Token) else ""
        body, *clauses = rest
        return RequirementItem(self._ident(name), text, body, tuple(clauses), self._span(meta))

    def bare(self, meta: Meta, children: Children) -> Bare:
        return Bare(children[0])

    def upon(self, meta: Meta, children: Children) -> Triggered:
        return Triggered(Mode.UPON, children[1], children[3])

    def whenever(self, meta: Meta, children: Children) -> Triggered:
        return Triggered(Mode.WHENEVER, children[1], children[3])

    def response(self, meta: Meta, children: Children) -> ResponseMonitor:
        return ResponseMonitor(children[-1], self._span(meta))

    def text_clause(self, meta: Meta, children: Children) -> TextClause:
        return TextClause(str(children[0]), _string(children[1]), self._span(meta))

    def tags(self, meta: Meta, children: Children) -> TagsClause:
        return TagsClause(tuple(map(_string, children[1:])), self._span(meta))

    def let(self, meta: Meta, children: Children) -> LetClause:
        return LetClause(self._ident(children[1]), children[2], self._span(meta))

    def for_each(self, meta: Meta, children: Children) -> ForEachClause:
        token = children[2]
        field = Name(_unquoted(token), self._span(token))
        return ForEachClause(self._ident(children[1]), field, self._span(meta))

    def at_end(self, meta: Meta, children: Children) -> AtEndClause:
        return AtEndClause(self._ident(children[1]), self._span(meta))

    def owned_property(self, meta: Meta, children: Children) -> PropertyClause:
        return PropertyClause(children[1], self._span(meta))


def _first(found: Sequence[_T]) -> _T | None:
    return found[0] if found else None


def _of(kind: type[_T], children: Iterable[Any]) -> list[_T]:
    return [child for child in children if isinstance(child, kind)]


def _unquoted(token: Token) -> str:
    return token[1:-1] if token.startswith("`") else str(token)


def _string(token: Token) -> str:
    """The text of a string, or a name as it is."""
    if not token.startswith('"'):
        return _unquoted(token)
    return re.sub(r"\\(.)", r"\1", token[1:-1])
