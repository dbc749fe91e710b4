"""Expressions as written to expressions over the network; constants are folded on the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import assert_never

from rvmon.diagnostics import Span
from rvmon.diagnostics.nearest import did_you_mean
from rvmon.errors import ModelError
from rvmon.timed.language import syntax
from rvmon.timed.language.foreign import type_reason
from rvmon.timed.language.linear import LINEAR_WORDS, linear_of
from rvmon.timed.language.symbols import clock_of, element_of, value_of
from rvmon.timed.model.evaluate import apply_binary, apply_unary
from rvmon.timed.model.expressions import (
    MAX_TIME,
    TRUE,
    BinaryOperation,
    Choice,
    ClockCompare,
    ClockOp,
    Constant,
    Deadlock,
    Expression,
    InLocation,
    PathFormula,
    UnaryOperation,
)
from rvmon.timed.model.guards import is_discrete
from rvmon.timed.model.operators import BaseType, BinaryOp, UnaryOp
from rvmon.timed.model.rules import model_error, refusal
from rvmon.timed.model.scope import (
    AutomatonKey,
    AutomatonSymbol,
    ClockSymbol,
    ConstantSymbol,
    ResolvedType,
    Scope,
    Symbol,
    TypeSymbol,
)

MAX_VALUES = 10_000
"""The most values that a quantifier, a `select`, a parameter or an array may range over."""

MAX_UNROLLED = 100_000
"""The most conditions that the quantifiers of a model may stand for together."""

INT16 = (-32768, 32767)
"""UPPAAL's `int` without a range."""

INT32 = (-(1 << 31), (1 << 31) - 1)
"""What a constant without a range may be."""

_CONNECTIVES = {BinaryOp.AND, BinaryOp.OR, BinaryOp.IMPLY, BinaryOp.EQ, BinaryOp.NE}
_COMPARISONS = {BinaryOp.LT, BinaryOp.LE, BinaryOp.EQ, BinaryOp.NE, BinaryOp.GE, BinaryOp.GT}
_MIRRORED = {
    BinaryOp.LT: BinaryOp.GT,
    BinaryOp.LE: BinaryOp.GE,
    BinaryOp.GE: BinaryOp.LE,
    BinaryOp.GT: BinaryOp.LT,
    BinaryOp.EQ: BinaryOp.EQ,
    BinaryOp.NE: BinaryOp.NE,
}


@dataclass(slots=True)
class Resolver:
    """What expressions may refer to beside the names of their scope.

    Attributes:
        automata: by name and arguments; only queries can see them.
        open_ints: whether `int` without a range is allowed.
        unrolled: conditions that quantifiers stood for so far.
    """

    automata: Mapping[AutomatonKey, AutomatonSymbol] = field(default_factory=dict)
    open_ints: bool = False
    unrolled: int = 0

    def expression(self, written: syntax.Expression, scope: Scope) -> Expression:
        """The expression over the network.

        Raises:
            ModelError: a name is unknown or of the wrong kind, or the expression has no meaning.
        """
        match written:
            case syntax.Number(value):
                return Constant(value)
            case syntax.Name("deadlock", _) if self.automata and not scope.find("deadlock"):
                return Deadlock()
            case syntax.Call(name, (body,), span) if name in LINEAR_WORDS and self.automata:
                return linear_of(name, self.expression(body, scope), span)
            case syntax.Name() | syntax.Index() | syntax.Member() | syntax.Call():
                if (location := self._location(written, scope)) is not None:
                    return location
                return value_of(self.symbol(written, scope), written.span)
            case syntax.Unary(op, operand, span):
                return _unary(op, self.expression(operand, scope), span)
            case syntax.Binary(op, left, right, span):
                if op in _COMPARISONS and (clocks := self._clock_compare(written, scope)):
                    return clocks
                first = self.expression(left, scope)
                if first == Constant(0) and op is BinaryOp.AND:
                    return first  # what stands behind need not have a meaning then
                return _binary(op, first, self.expression(right, scope), span)
            case syntax.Conditional(condition, then, otherwise, _):
                test = self.expression(condition, scope)
                yes, no = self.expression(then, scope), self.expression(otherwise, scope)
                if isinstance(test, Constant):
                    return yes if test.value else no
                return Choice(test, yes, no)
            case syntax.Quantified(universal, name, kind, body, span):
                values = values_of(self.type(kind, scope), kind.span)
                self._count(len(values), span)
                parts = [
                    self.expression(body, scope.inner({name: ConstantSymbol(value)}))
                    for value in values
                ]
                return _joined(BinaryOp.AND if universal else BinaryOp.OR, parts, span)
            case syntax.Path(op, body, bound, span, left):
                if not self.automata:
                    raise model_error("TA020", "only queries speak of runs", span)
                until = TRUE if left is None else self.expression(left, scope)
                return PathFormula(
                    op, self.expression(body, scope), self.limit(bound, scope), until
                )
            case syntax.LeadsTo(_, _, _, span):
                fix = "write A[] (p imply A<> q)"
                raise model_error("TA020", "`-->` can only stand outermost", span, fix)
            case syntax.Assuming() | syntax.Chance() | syntax.Mean():
                raise model_error("TA020", "this can only stand outermost", written.span)
            case _:
                assert_never(written)

    def _count(self, parts: int, span: Span) -> None:
        self.unrolled += parts
        if self.unrolled > MAX_UNROLLED:
            message = f"quantifiers stand for more than {MAX_UNROLLED:,} conditions"
            raise model_error("TA019", message, span, "let them range over smaller types")

    def constant(self, written: syntax.Expression, scope: Scope) -> int:
        """The value of an expression that must not depend on the state.

        Raises:
            ModelError: it does, or it has none.
        """
        match self.expression(written, scope):
            case Constant(value):
                return value
            case _:
                fix = "use numbers, `const` names and parameters only"
                raise model_error("TA006", "this is not constant", written.span, fix)

    def limit(self, written: syntax.Expression | None, scope: Scope) -> int | None:
        """The bound of a path operator in units of time, if it has one.

        Raises:
            ModelError: it is not constant, or no time.
        """
        if written is None:
            return None
        units = self.constant(written, scope)
        if not 0 <= units < MAX_TIME:
            fix = f"bounds are from 0 to {MAX_TIME - 1:,}"
            raise model_error("TA007", f"a bound of {units}", written.span, fix)
        return units

    def type(self, written: syntax.TypeText, scope: Scope) -> ResolvedType:
        """The type with its range evaluated.

        Raises:
            ModelError: the range is empty, missing, or not constant; the typedef does not exist.
        """
        prefixes = {
            "const": written.const, "broadcast": written.broadcast, "urgent": written.urgent
        }  # fmt: skip
        if written.base is BaseType.NAMED:
            symbol = scope.find(written.name)
            if not isinstance(symbol, TypeSymbol):
                if (reason := type_reason(written.name)) is not None:
                    raise model_error("TA016", reason[0], written.span, reason[1])
                types = [n for n in scope.names() if isinstance(scope.find(n), TypeSymbol)]
                fix = did_you_mean(written.name, [*types, "int", "bool", "clock", "chan"])
                raise model_error("TA002", f"no type named `{written.name}`", written.span, fix)
            base = symbol.type
            return replace(
                base,
                const=base.const or written.const,
                broadcast=base.broadcast or written.broadcast,
                urgent=base.urgent or written.urgent,
            )
        if written.base is not BaseType.INT:
            return ResolvedType(written.base, 0, 1, **prefixes)
        if written.low is None or written.high is None:
            if not (self.open_ints or written.const):
                fix = "give its range: int[low, high]"
                raise model_error("TA005", "an int without a range", written.span, fix)
            return ResolvedType(BaseType.INT, *(INT32 if written.const else INT16), **prefixes)
        low, high = self.constant(written.low, scope), self.constant(written.high, scope)
        if low > high:
            raise model_error("TA007", f"the range [{low}, {high}] is empty", written.span)
        return ResolvedType(BaseType.INT, low, high, **prefixes)

    def symbol(self, written: syntax.Expression, scope: Scope) -> Symbol:
        """What a name, an element or a member stands for.

        Raises:
            ModelError: nothing has that name, or the expression is no name.
        """
        match written:
            case syntax.Name(name, span):
                symbol = scope.find(name)
                if symbol is None and scope.names_automaton(name):
                    raise _no_value(span)
                if symbol is None and scope.declares(name):
                    raise refusal()  # why its declaration has no meaning is reported there
                if symbol is None:
                    candidates = [*scope.names(), *(n for n, _ in self.automata)]
                    raise model_error(
                        "TA002", f"no name `{name}`", span, did_you_mean(name, candidates)
                    )
                return symbol
            case syntax.Index(base, index, span):
                position = self.expression(index, scope)
                _refuse_clocks(position, index.span)
                return element_of(self.symbol(base, scope), position, span)
            case syntax.Member(base, name, span):
                automaton = self._automaton(base, scope)
                if name in automaton.scope.symbols:
                    return automaton.scope.symbols[name]
                names = [*automaton.locations, *automaton.scope.symbols]
                message = f"no location or variable `{name}` in this automaton"
                raise model_error("TA002", message, span, did_you_mean(name, names))
            case syntax.Call(name, _, span):
                if any(name == known for known, _ in self.automata):
                    raise _no_value(span)
                fix = "write the value out, or use an array"
                raise model_error(
                    "TA016", f"functions such as `{name}` are not supported", span, fix
                )
            case _:
                fix = "name a variable, a clock or a channel"
                raise model_error("TA004", "this is no name", written.span, fix)

    def clock(self, written: syntax.Expression, scope: Scope) -> int | None:
        """The clock that an expression names, if it names one."""
        if not isinstance(written, syntax.Name | syntax.Index | syntax.Member):
            return None
        if self._location(written, scope) is not None:
            return None
        match self.symbol(written, scope):
            case ClockSymbol(slot):
                return clock_of(slot, written.span)
            case _:
                return None

    def _clock_compare(self, written: syntax.Binary, scope: Scope) -> Expression | None:
        _refuse_difference(self, written, scope)
        left, right = self.clock(written.left, scope), self.clock(written.right, scope)
        if left is not None and right is not None:
            fix = "compare each clock with a number; a clock reset with the one can stand for it"
            raise model_error("TA008", "two clocks are compared", written.span, fix)
        if left is not None:
            bound = self.expression(written.right, scope)
            return compare_clock(left, written.op, bound, written.span)
        if right is not None:
            op = _MIRRORED[written.op]
            return compare_clock(right, op, self.expression(written.left, scope), written.span)
        return None

    def _location(self, written: syntax.Expression, scope: Scope) -> InLocation | None:
        if not isinstance(written, syntax.Member):
            return None
        automaton = self._automaton(written.base, scope)
        if written.name not in automaton.locations:
            return None
        return InLocation(automaton.index, automaton.locations[written.name])

    def _automaton(self, written: syntax.Expression, scope: Scope) -> AutomatonSymbol:
        match written:
            case syntax.Name(name, span):
                key: AutomatonKey = (name, ())
            case syntax.Call(name, arguments, span):
                key = (name, tuple(self.constant(a, scope) for a in arguments))
            case _:
                span = written.span
                key = ("", ())
        if key not in self.automata:
            families = {name for name, _ in self.automata}
            fix = (
                did_you_mean(key[0], sorted(families)) if self.automata else "only queries see them"
            )
            raise model_error("TA002", f"no automaton `{span.text}`", span, fix)
        return self.automata[key]


def _refuse_difference(resolver: Resolver, written: syntax.Binary, scope: Scope) -> None:
    for side in (written.left, written.right):
        if not isinstance(side, syntax.Binary) or side.op not in (BinaryOp.SUB, BinaryOp.ADD):
            continue
        if any(resolver.clock(part, scope) is not None for part in (side.left, side.right)):
            fix = "diagonal constraints are not supported: compare each clock with a number"
            raise model_error("TA008", "a difference or sum of clocks", written.span, fix)


def compare_clock(clock: int, op: BinaryOp, bound: Expression, span: Span) -> Expression:
    """A comparison of a clock as one or two bounds.

    Raises:
        ModelError: the bound is no number of units of time.
    """
    if not is_discrete(bound):
        raise model_error("TA008", "a clock compared with clocks", span)
    if isinstance(bound, Constant) and not 0 <= bound.value < MAX_TIME:
        fix = f"clocks are compared with numbers from 0 to {MAX_TIME - 1:,}"
        raise model_error("TA007", f"a clock compared with {bound.value}", span, fix)
    match op:
        case BinaryOp.EQ:
            return BinaryOperation(
                BinaryOp.AND,
                ClockCompare(clock, ClockOp.GE, bound),
                ClockCompare(clock, ClockOp.LE, bound),
            )
        case BinaryOp.NE:
            return BinaryOperation(
                BinaryOp.OR,
                ClockCompare(clock, ClockOp.LT, bound),
                ClockCompare(clock, ClockOp.GT, bound),
            )
        case _:
            return ClockCompare(clock, ClockOp(op.value), bound)


def _unary(op: UnaryOp, operand: Expression, span: Span) -> Expression:
    if op is not UnaryOp.NOT:
        _refuse_clocks(operand, span)
    if isinstance(operand, Constant):
        return Constant(apply_unary(op, operand.value))
    return UnaryOperation(op, operand)


def _refuse_clocks(operand: Expression, span: Span) -> None:
    if not is_discrete(operand):
        fix = "arithmetic is for numbers; join conditions by and, or, not, imply"
        raise model_error("TA009", "a condition on clocks or runs is no number", span, fix)


def _binary(op: BinaryOp, left: Expression, right: Expression, span: Span) -> Expression:
    if op not in _CONNECTIVES:
        _refuse_clocks(left, span)
        _refuse_clocks(right, span)
    match op, left, right:
        case BinaryOp.DIV | BinaryOp.MOD, _, Constant(0):
            raise model_error("TA007", "division by zero", span)
        case _, Constant(a), Constant(b):
            return Constant(apply_binary(op, a, b))
        case BinaryOp.AND, Constant(value), other:
            return truth(other) if value else Constant(0)
        case BinaryOp.OR, Constant(value), other:
            return TRUE if value else truth(other)
        case BinaryOp.IMPLY, Constant(value), other:
            return truth(other) if value else TRUE
        case BinaryOp.IMPLY, other, Constant(0):
            return UnaryOperation(UnaryOp.NOT, other)
        case BinaryOp.DIV | BinaryOp.MOD, _, _:
            return BinaryOperation(op, left, right, span)
        case _:
            return BinaryOperation(op, left, right)


def _no_value(span: Span) -> ModelError:
    fix = f"name a location: {span.text}.location"
    return model_error("TA004", "an automaton is no value", span, fix)


def _joined(op: BinaryOp, parts: Sequence[Expression], span: Span) -> Expression:
    """Conditions joined as a balanced tree, which stays shallow however many there are."""
    if len(parts) == 1:
        return truth(parts[0])
    half = len(parts) // 2
    return _binary(op, _joined(op, parts[:half], span), _joined(op, parts[half:], span), span)


def truth(expression: Expression) -> Expression:
    """The expression, which counts as a truth value where it stands."""
    return Constant(int(bool(expression.value))) if isinstance(expression, Constant) else expression


def values_of(kind: ResolvedType, span: Span) -> range:
    """All values of a finite type.

    Raises:
        ModelError: the type has none or too many.
    """
    if kind.base not in (BaseType.INT, BaseType.BOOL):
        raise model_error("TA004", "only int and bool types can be enumerated", span)
    if kind.high - kind.low >= MAX_VALUES:
        fix = "give a small range: int[low, high]"
        raise model_error("TA019", f"more than {MAX_VALUES:,} values", span, fix)
    return range(kind.low, kind.high + 1)
