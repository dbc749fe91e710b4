"""Turns the parse tree of an item into the syntax tree."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any

from lark import Token, Tree

from rvmon.diagnostics import Diagnostic, Source, Span
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.formula import BinaryOp, Bound, CompareOp, UnaryOp
from rvmon.language.checked.properties import BinKind
from rvmon.language.checked.specification import Mode, Role, TimeModel
from rvmon.language.rules import Refusal, short
from rvmon.language.rules import syntax as rules
from rvmon.language.syntax import expressions as ast
from rvmon.language.syntax import items

_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")
_LARGEST = 400
"""Numbers with more digits before the point, or more zeros after it, are out of range."""
_MARKS = {
    "SPEC", "TIME", "MAX_DELAY", "IMPORT", "COVER", "COVERPOINT", "CROSS", "SCOPE", "BEFORE",
    "AFTER", "BETWEEN", "UNTIL", "SIGNAL", "EVENT", "DEFINE", "CONST", "REQUIREMENT",
    "PROPERTY", "UPON", "WHENEVER", "THEN", "IF", "ELSE", "TAGS", "LET", "FOR_EACH", "AT_END",
    "IGNORE_NAN", "STALE_AFTER", "STEP", "MONITOR_AS_RESPONSE", "MONITOR_AS_WRITTEN",
    "MONITOR_AS_COVER",
}  # fmt: skip
"""Terminals without content: the name of the grammar rule says the same."""


class Builder:
    """Builds the syntax tree of one item by recursion; the depth was limited before.

    `offset` is the position in the file at which the parsed text starts.
    """

    def __init__(self, source: Source, offset: int) -> None:
        self.findings: list[Diagnostic] = []  # about the syntax of the item
        self._source = source
        self._offset = offset

    def built(self, tree: Tree[Token]) -> Any:
        """The syntax node of a grammar rule, made of its span and its parts.

        Terminals in `_MARKS` are not parts.

        Raises:
            Refusal: it has an error beyond the grammar, such as a chain of comparisons.
        """
        parts = [
            self.built(child) if isinstance(child, Tree) else self._word(child)
            for child in tree.children
            if isinstance(child, Tree) or child.type not in _MARKS
        ]
        span = self._span(tree.meta.start_pos, tree.meta.end_pos)
        made = _MADE.get(tree.data) or getattr(self, tree.data)
        return made(*parts, span) if isinstance(made, type) else made(span, *parts)

    def _span(self, start: int, end: int) -> Span:
        return Span(self._source, self._offset + start, self._offset + end)

    def _word(self, token: Token) -> ast.Ident | str:
        """The word of a token with its place, without backticks or the bracket of a call.

        A string token gives its plain text.
        """
        start, end = token.start_pos or 0, token.end_pos or 0
        if token.type == "STRING":
            return re.sub(r"\\(.)", r"\1", token[1:-1])
        if token.type == "CALL":
            return ast.Ident(token[:-1], self._span(start, end - 1))
        return ast.Ident(token[1:-1] if token[0] == "`" else str(token), self._span(start, end))

    def chain(self, _: Span, *parts: Any) -> ast.Infix:
        """A chain of operands with connectives of one precedence between them."""
        operands, words = parts[::2], parts[1::2]
        if not _are_alike(operands):
            for operand in operands[:-1]:
                self._check_reach(operand, operands[-1])
        if BinaryOp.of(words[0].text) is not BinaryOp.IFF:
            self._check_sides(operands, words)
        infix: ast.Infix = _balanced(operands, words)
        return infix

    def infix(self, span: Span, left: ast.Expression, word: ast.Ident, *rest: Any) -> ast.Infix:
        """An operator of the `until` family, or an implication."""
        *window, right = rest
        op = BinaryOp.of(" ".join(word.text.split()))
        self._check_reach(left, right)
        # These operators group to the right, so a second one without brackets is the right side.
        if op.is_kin_of_until and isinstance(right, ast.Infix) and right.op is not op:
            self.findings.append(rules.mixed_chain(right.op_span, word.span, short(word.span.text)))
        return ast.Infix(op, left, first_of(window), right, word.span, span)

    def _check_sides(self, operands: Sequence[ast.Expression], words: Sequence[ast.Ident]) -> None:
        """Report operands of a connective that are an unbracketed `until` or its kin."""
        for number, operand in enumerate(operands):
            if isinstance(operand, ast.Infix) and operand.op.is_kin_of_until:
                word = words[min(number, len(words) - 1)]
                near = operand.right if number < len(words) else operand.left
                self.findings.append(
                    rules.two_sides(operand.span, operand.op_span, word.span, near.span)
                )

    def _check_reach(self, left: ast.Expression, last: ast.Expression) -> None:
        """Report a temporal prefix with an unbracketed operand right before a connective."""
        edge = left
        while True:
            match edge:
                case ast.Prefix(op=UnaryOp.NOT, operand=inner) | ast.Infix(right=inner):
                    edge = inner
                case ast.Prefix() | ast.Path(reaching=False):
                    break
                case _:
                    return
        if not isinstance(edge.operand, ast.Group):
            operand = edge.operand.span
            operator = Span(operand.source, edge.span.start, operand.start)
            self.findings.append(rules.reach(operator, operand, last.span))


def _are_alike(operands: Sequence[ast.Expression]) -> bool:
    """Whether all operands start with the same temporal prefix, so nobody misreads the chain."""
    firsts = {operand.op if isinstance(operand, ast.Prefix) else None for operand in operands}
    return len(firsts) == 1 and not firsts & {None, UnaryOp.NOT}


def _balanced(operands: Sequence[Any], words: Sequence[ast.Ident]) -> Any:
    """A balanced tree of a chain: the connectives are associative, so it need not become deep."""
    if len(operands) == 1:
        return operands[0]
    middle = (len(operands) + 1) // 2
    left = _balanced(operands[:middle], words[: middle - 1])
    right = _balanced(operands[middle:], words[middle:])
    word = words[middle - 1]
    return ast.Infix(BinaryOp.of(word.text), left, None, right, word.span, left.span.to(right.span))


def first_of(parts: Sequence[Any]) -> Any:
    """The first part, or `None`."""
    return parts[0] if parts else None


def _number(span: Span, word: ast.Ident) -> ast.Number:
    digits = word.text[: _NUMBER.match(word.text).end()]  # type: ignore[union-attr]  # terminal NUMBER
    decimal = Decimal(digits)
    # As a fraction, `1e999999999` would take half a gigabyte.
    small = abs(decimal.adjusted()) <= _LARGEST and len(digits) <= 2 * _LARGEST
    value = Fraction(decimal) if small or not decimal else None
    return ast.Number(value, word.text[len(digits) :].strip(), span)


def _comparison(
    span: Span, left: ast.Expression, word: ast.Ident, right: ast.Expression, *rest: Any
) -> Any:
    if rest:
        further = rest[0].text, rest[1].span
        raise Refusal(rules.comparison_chain(left.span, word.text, right.span, *further))
    op = CompareOp("==" if word.text == "=" else word.text)
    return ast.Comparison(op, left, right, word.span, span)


def _among(span: Span, left: ast.Expression, *rest: Any) -> ast.Expression:
    values = [part for part in rest if not isinstance(part, ast.Ident)]
    equal = [ast.Comparison(CompareOp.EQ, left, value, value.span, span) for value in values]
    either: ast.Expression = equal[0]
    for further in equal[1:]:
        either = ast.Infix(BinaryOp.OR, either, None, further, span, span)
    either = ast.Group(either, span)
    denied = len(values) < len(rest)
    return ast.Prefix(UnaryOp.NOT, None, either, span, span) if denied else either


def _prefix(span: Span, word: ast.Ident, *rest: Any) -> ast.Prefix | ast.Immediately:
    *window, operand = rest
    if word.text == "immediately":
        return ast.Immediately(operand, span)
    return ast.Prefix(UnaryOp.of(word.text), first_of(window), operand, word.span, span)


def _bounded(
    span: Span, word: ast.Ident, bound: ast.Expression | ast.Window, operand: ast.Expression
) -> ast.Prefix:
    op = UnaryOp.EVENTUALLY if word.text == "within" else UnaryOp.ALWAYS
    window = (
        bound
        if isinstance(bound, ast.Window)
        else ast.Window(None, bound, False, False, bound.span)
    )
    return ast.Prefix(op, window, operand, word.span, span)


def _path(span: Span, word: ast.Ident, *rest: Any) -> ast.Path:
    *window, operand = rest
    reaching = word.text[1] in "[<"
    op = UnaryOp.of({"[": "G", "<": "F"}.get(word.text[1], word.text[1]))
    return ast.Path(word.text[0] == "A", op, first_of(window), operand, reaching, word.span, span)


def _at_most(span: Span, *parts: Any) -> ast.Window:
    (bound,) = (part for part in parts if not isinstance(part, ast.Ident))
    return ast.Window(None, bound, False, False, span)


def _window(
    span: Span, opening: ast.Ident, low: ast.Expression, high: Any, closing: ast.Ident
) -> ast.Window:
    end = None if isinstance(high, ast.Ident) else high
    return ast.Window(low, end, opening.text == "(", closing.text == ")", span)


def _text(part: ast.Ident | str) -> str:
    return part if isinstance(part, str) else part.text


def _signals(
    span: Span, names: Sequence[ast.Ident], type_: items.TypeSyntax, *rest: Any
) -> items.Declarations:
    role = first_of([part for part in rest if isinstance(part, Role)])
    ignored = first_of([part for part in rest if isinstance(part, Span)])
    stale = first_of([part for part in rest if not isinstance(part, Role | Span)])
    signals = (items.SignalSyntax(name, type_, role, ignored, stale) for name in names)
    return items.Declarations(tuple(signals), span)


def _events(span: Span, *parts: Any) -> items.Declarations:
    role = parts[-1] if isinstance(parts[-1], Role) else None
    named = parts if role is None else parts[:-1]
    events = (items.EventSyntax(name, fields, role) for name, fields in named)
    return items.Declarations(tuple(events), span)


def _requirement(span: Span, name: ast.Ident, *rest: Any) -> items.RequirementItem:
    text, *parts = rest if isinstance(rest[0], str) else ("", *rest)
    (body, early), *clauses = parts
    return items.RequirementItem(name, text, body, (*early, *clauses), span)


def _triggered(mode: Mode, trigger: ast.Expression, *rest: Any) -> tuple[items.Triggered, Any]:
    """A trigger with its consequent, and the clauses between the two."""
    *clauses, consequent = rest
    return items.Triggered(mode, trigger, consequent), clauses


def _bin(span: Span, *parts: Any) -> items.BinSyntax:
    names = [part for part in parts if isinstance(part, ast.Ident)]
    values = first_of([part for part in parts if not isinstance(part, ast.Ident)])
    kind = BinKind(names[0].text) if len(names) > 1 else BinKind.GOAL
    return items.BinSyntax(names[-1], values, kind, span)


def _coverpoint(span: Span, name: ast.Ident, *rest: Any) -> items.CoverpointItem:
    bins = tuple(part for part in rest if isinstance(part, items.BinSyntax))
    expression = None if isinstance(rest[0], items.BinSyntax) else rest[0]
    clauses = rest[len(bins) + (expression is not None) :]
    return items.CoverpointItem(name, expression, bins, clauses, span)


_MADE: Mapping[str, Callable[..., Any]] = {
    # Expressions.
    "literal": _number,
    "name": lambda span, word: ast.Name(word.text, span),
    "truth": lambda span, word: ast.Truth(word.text == "true", span),
    "edge": lambda span, word: ast.Edge(Bound(word.text), span),
    "group": ast.Group,
    "minus": lambda span, _, operand: ast.Operation(NumericOp.NEG, (operand,), span),
    "arithmetic": lambda span, left, word, right: ast.Operation(
        NumericOp.of(word.text), (left, right), span
    ),
    "call": lambda span, function, *args: ast.Call(function, args, span),
    "choice": ast.Choice,
    "comparison": _comparison,
    "among": _among,
    "prefix": _prefix,
    "bounded": _bounded,
    "path": _path,
    "quantified": lambda span, word, path: ast.Quantified(word.text == "A", path, span),
    "leads_to": lambda span, left, _, *rest: ast.LeadsTo(left, first_of(rest[:-1]), rest[-1], span),
    "at_most": _at_most,
    "window": _window,
    # Declarations.
    "header": lambda span, name, title="": items.Header(name, title, span),
    "import_item": lambda span, target: items.ImportItem(
        _text(target), isinstance(target, ast.Ident), span
    ),
    "time_held": lambda span: items.TimeItem(TimeModel.HELD, None, span),
    "time_sampled": lambda span: items.TimeItem(TimeModel.SAMPLED, None, span),
    "time_clocked": lambda span, period: items.TimeItem(TimeModel.CLOCKED, period, span),
    "delay": items.DelayItem,
    "signals": _signals,
    "names": lambda _, *names: names,
    "bool_type": lambda span: items.TypeSyntax("bool", "", (), span),
    "int_type": lambda span: items.TypeSyntax("int", "", (), span),
    "real_type": lambda span, *unit: items.TypeSyntax(
        "real", unit[0].text.strip() if unit else "", (), span
    ),
    "label_type": lambda span, labels: items.TypeSyntax("label", "", labels, span),
    "role": lambda _, word: Role(word.text),
    "ignored": lambda span: span,
    "stale": lambda _, bound: bound,
    "events": _events,
    "event_name": lambda _, name: (name, ()),
    "event_call": lambda _, name, *fields: (name, fields),
    "field": lambda _, name, type_: items.FieldSyntax(name, type_),
    "define_name": lambda span, name, body: items.DefineItem(name, None, body, span),
    "define_call": items.DefineItem,
    "constant": items.ConstItem,
    # Requirements.
    "property": items.PropertyItem,
    "requirement": _requirement,
    "bare": lambda _, formula: (items.Bare(formula), ()),
    "upon": lambda _, *parts: _triggered(Mode.UPON, *parts),
    "whenever": lambda _, *parts: _triggered(Mode.WHENEVER, *parts),
    "response": lambda span, *within: (items.ResponseMonitor(within[-1], span), ()),
    "written": lambda span: (items.WrittenMonitor(span), ()),
    "shown": lambda span: (items.CoverMonitor(span), ()),
    "text_clause": lambda span, word, text: items.TextClause(word.text, _text(text), span),
    "tags": lambda span, *tags: items.TagsClause(tuple(map(_text, tags)), span),
    "let": items.LetClause,
    "for_each": lambda span, name, field: items.ForEachClause(
        name, ast.Name(field.text, field.span), span
    ),
    "at_end": items.AtEndClause,
    "owned_property": items.PropertyClause,
    "run_share": lambda span, words, share: items.RunShareClause(
        words.text.endswith("least"), _number(span, share), span
    ),
    "scope_before": lambda span, closing: items.ScopeClause(None, closing, True, span),
    "scope_after": lambda span, opening: items.ScopeClause(opening, None, False, span),
    "scope_after_until": lambda span, *ends: items.ScopeClause(ends[0], ends[-1], False, span),
    "scope_between": lambda span, opening, _, closing: items.ScopeClause(
        opening, closing, True, span
    ),
    # Goals.
    "cover": items.CoverItem,
    "coverpoint": _coverpoint,
    "bin": _bin,
    "steps": lambda span, *values: items.StepsSyntax(values, span),
    "cross": lambda span, name, points, *clauses: items.CrossItem(name, points, clauses, span),
    "sampled": items.SampledClause,
    "count": lambda span, word, count: items.CountClause(word.text, _number(span, count), span),
    "unwanted": lambda span, word, condition: items.UnwantedClause(
        BinKind(word.text), condition, span
    ),
}
"""For each rule of `rv.lark`, the maker of its node from span and parts.

The rules `chain` and `infix` are methods of `Builder`, because they report findings.
"""
