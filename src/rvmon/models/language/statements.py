"""Updates and bodies of functions: from written statements to statements over the network."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import assert_never

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models.language import symbols, syntax
from rvmon.models.language.operations import clock_number, fitted
from rvmon.models.language.resolve import Resolver
from rvmon.models.network import expressions as ex
from rvmon.models.network import scope as sc
from rvmon.models.network.guards import is_discrete


def number(written: syntax.Expression, scope: sc.Scope, resolver: Resolver) -> ex.Expression:
    """An expression whose value depends on locations and variables alone."""
    value = resolver.expression(written, scope)
    diagonals = resolver.diagonals
    if not is_discrete(value) or (diagonals is not None and diagonals.are_read(value)):
        fix = "set variables from numbers and variables only"
        raise model_error("TA009", "a clock's state is written to a variable", written.span, fix)
    return value


def updates_of(
    written: Sequence[syntax.UpdateText | syntax.Call], scope: sc.Scope, resolver: Resolver
) -> tuple[ex.Statement, ...]:
    """The updates of an edge."""
    return tuple(s for update in written for s in _update(update, scope, resolver))


def is_price(target: syntax.Expression, scope: sc.Scope) -> bool:
    """Whether this is the cost or reward of priced automata, which nothing reads."""
    match target:
        case syntax.Name("cost" | "reward" as name):
            return not scope.declares(name) and not scope.names_automaton(name)
        case _:
            return False


def _update(
    written: syntax.UpdateText | syntax.Call, scope: sc.Scope, resolver: Resolver
) -> list[ex.Statement]:
    if isinstance(written, syntax.Call):
        match resolver.expression(written, scope):
            case (ex.Invoke() as call) | ex.Fractional("=", (ex.Invoke() as call,)):
                return [call]
            case _:
                raise model_error("TA004", "this is not a function", written.span)
    if is_price(written.target, scope):
        return []
    clock = resolver.clock(written.target, scope)
    if clock is not None:
        value = clock_number(number(written.value, scope, resolver))
        if isinstance(value, ex.Constant) and not 0 <= value.value < ex.MAX_TIME:
            raise model_error("TA007", f"a clock is set to {value.value}", written.span)
        return [ex.Reset(clock, value, written.span)]
    target = resolver.symbol(written.target, scope)
    if symbols.is_whole(target) and isinstance(
        written.value, syntax.Name | syntax.Index | syntax.Member
    ):
        return _copy(target, resolver.symbol(written.value, scope), written.span, resolver)
    return [_set(target, number(written.value, scope, resolver), written.target.span, resolver)]


def _copy(
    target: sc.Symbol, source: sc.Symbol, span: Span, resolver: Resolver
) -> list[ex.Statement]:
    """Set an array or record to another one, element by element."""
    if not symbols.is_alike(target, source):
        raise model_error("TA004", "these have different types", span)
    pairs = zip(symbols.leaves(target), symbols.leaves(source), strict=True)
    return [_set(one, symbols.value_of(other, span), span, resolver) for one, other in pairs]


def _set(target: sc.Symbol, value: ex.Expression, span: Span, resolver: Resolver) -> ex.Statement:
    match target:
        case sc.PlacedSymbol(ex.BaseType.INT, slot) if slot.is_single:
            variable = resolver.functions.variable(slot.first)
            value = fitted(value, variable.is_real, span)
            return ex.Assignment(replace(slot, span=span), value, variable)
        case _:
            fix = "only variables and clocks can be set"
            raise model_error("TA004", "this cannot be set", span, fix)


@dataclass(frozen=True, slots=True)
class Bodies:
    """Builds the body of one function."""

    text: syntax.FunctionText
    resolver: Resolver

    def statements(
        self, written: Sequence[syntax.Statement], scope: sc.Scope
    ) -> tuple[list[ex.Statement], bool]:
        """The statements that can be reached, and whether their end can be reached."""
        made: list[ex.Statement] = []
        for statement in written:
            more, continues = self._statement(statement, scope)
            made += more
            if not continues:
                return made, False
        return made, True

    def _statement(
        self, written: syntax.Statement, scope: sc.Scope
    ) -> tuple[list[ex.Statement], bool]:
        resolver = self.resolver
        match written:
            case syntax.Declaration():
                return self._declaration(written, scope), True
            case syntax.UpdateText() | syntax.Call():
                return _update(written, scope, resolver), True
            case syntax.Block(statements):
                return self.statements(statements, scope.inner({}))
            case syntax.Branch(condition, then, otherwise):
                test = number(condition, scope, resolver)
                yes, after_yes = self.statements(then, scope.inner({}))
                no, after_no = self.statements(otherwise, scope.inner({}))
                return [ex.If(test, tuple(yes), tuple(no))], after_yes or after_no
            case syntax.Loop(condition, inside, span):
                test = number(condition, scope, resolver)
                body, _ = self.statements(inside, scope.inner({}))
                return [ex.While(test, tuple(body), span)], True
            case syntax.Each():
                return self._each(written, scope), True
            case syntax.ReturnText(None, span) if self.text.type is not None:
                raise model_error("TA004", f"`{self.text.name}` returns a value", span)
            case syntax.ReturnText(value, span) if value is not None:
                if self.text.type is None:
                    raise model_error("TA004", f"`{self.text.name}` returns no value", span)
                real = self.text.type.base is ex.BaseType.DOUBLE
                return [ex.Return(fitted(number(value, scope, resolver), real, span))], False
            case syntax.ReturnText():
                return [ex.Return(ex.Constant(0))], False
            case _:
                assert_never(written)

    def _declaration(self, item: syntax.Declaration, scope: sc.Scope) -> list[ex.Statement]:
        resolver = self.resolver
        symbols.claim(item.name, item.span, scope)
        kind = resolver.typed(item, scope)
        if kind.base in (ex.BaseType.CLOCK, ex.BaseType.CHANNEL):
            fix = "declare it outside the function"
            raise model_error("TA004", "a clock or channel in a function", item.span, fix)
        initial = item.initial
        if kind.const and initial is not None and not (kind.extents or kind.fields):
            real = kind.base is ex.BaseType.DOUBLE
            value = fitted(self._single(initial, scope), real, initial.span)
            if isinstance(value, ex.Constant):
                symbols.check_range(value.value, kind, initial.span)
                scope.symbols[item.name] = sc.ConstantSymbol(value.value)
                return []
        name = f"{self.text.name}.{item.name}"
        symbol = symbols.laid_out(kind, [name], None, resolver.functions)
        statements = self._initial(symbol, initial, kind, scope)
        scope.symbols[item.name] = symbol  # only now: the initial value may use an outer meaning
        return statements

    def _initial(
        self,
        symbol: sc.Symbol,
        written: syntax.Initial | None,
        kind: sc.ResolvedType,
        scope: sc.Scope,
    ) -> list[ex.Statement]:
        """Set a local variable completely; nothing remains from the previous call."""
        resolver = self.resolver
        if written is None:
            single = [leaf for leaf in symbols.leaves(symbol) if isinstance(leaf, sc.PlacedSymbol)]
            span = self.text.span
            initial = [resolver.functions.variable(leaf.slot.first).initial for leaf in single]
            return [
                _set(leaf, ex.Constant(value), span, resolver)
                for leaf, value in zip(single, initial, strict=True)
            ]
        if (kind.extents or kind.fields) and not isinstance(written, syntax.Values):
            return _copy(symbol, resolver.symbol(written, scope), written.span, resolver)
        parts = symbols.parts_of_initial(written, kind)
        if parts is None:
            return [_set(symbol, self._single(written, scope), written.span, resolver)]
        if isinstance(symbol, sc.RecordSymbol) and not kind.extents:
            members = [inner for _, inner in symbol.fields]
        else:
            indices = map(ex.Constant, kind.extents[0])
            members = [symbols.element_of(symbol, index, written.span) for index in indices]
        pairs = zip(members, parts, strict=True)
        return [s for member, part in pairs for s in self._initial(member, *part, scope)]

    def _single(self, written: syntax.Initial, scope: sc.Scope) -> ex.Expression:
        """The initial value of a scalar."""
        if isinstance(written, syntax.Values):
            raise model_error("TA004", "one value expected, a list found", written.span)
        return number(written, scope, self.resolver)

    def _each(self, written: syntax.Each, scope: sc.Scope) -> list[ex.Statement]:
        resolver, inner = self.resolver, scope.inner({})
        values = symbols.values_of(resolver.type(written.type, scope), written.type.span)
        span = written.span
        kind = sc.ResolvedType(ex.BaseType.INT, values.start, values.stop)
        place = resolver.functions.place(kind, [f"{self.text.name}.{written.name}"], None)
        symbol = sc.PlacedSymbol(ex.BaseType.INT, ex.Slot(place))
        inner.symbols[written.name], inner.places[written.name] = symbol, span
        body, continues = self.statements(written.body, inner.inner({}))
        here = ex.VariableValue(symbol.slot)
        if continues:
            after = ex.BinaryOperation(ex.BinaryOp.ADD, here, ex.Constant(1))
            body.append(_set(symbol, after, span, resolver))
        first = _set(symbol, ex.Constant(values.start), span, resolver)
        test = ex.BinaryOperation(ex.BinaryOp.LT, here, ex.Constant(values.stop))
        return [first, ex.While(test, tuple(body), span)]
