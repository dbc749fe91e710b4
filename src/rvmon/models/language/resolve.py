"""Resolves written expressions to expressions over the network, and folds constants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import assert_never

from rvmon.diagnostics import Span
from rvmon.errors import ModelError
from rvmon.models import model_error, refusal, unknown
from rvmon.models.language import operations, symbols, syntax
from rvmon.models.language.diagonals import Diagonals, difference, terms_of
from rvmon.models.language.unsupported import refuse_foreign, type_reason
from rvmon.models.network import expressions as ex
from rvmon.models.network import scope as sc
from rvmon.models.network.evaluate import evaluator
from rvmon.models.network.fractions import FUNCTIONS, literal
from rvmon.models.network.guards import is_fixed, refuse_changes
from rvmon.texts import did_you_mean

MAX_UNROLLED = 100_000  # limit for the conditions that all quantifiers of a model stand for


@dataclass(slots=True)
class Resolver:
    """Resolves expressions, given their scope and what they may refer to besides it."""

    functions: symbols.Calls  # the functions that can be called
    # by name and arguments; empty except for queries and signals
    automata: Mapping[sc.AutomatonKey, sc.AutomatonSymbol] = field(default_factory=dict)
    open_ints: bool = False  # whether `int` may lack a range
    # replaces differences of clocks; `None` where they may not be compared
    diagonals: Diagonals | None = None
    unrolled: int = 0  # number of conditions that quantifiers stood for so far
    fraction: Span | None = None  # the place of the first number with a fraction

    def expression(self, written: syntax.Expression, scope: sc.Scope) -> ex.Expression:
        """Resolve an expression."""
        match written:
            case syntax.Number(value):
                return ex.Constant(value)
            case syntax.Decimal(value, span):
                self.fraction = self.fraction or span
                return literal(value)
            case syntax.Name("deadlock", _) if self.automata and not scope.find("deadlock"):
                return ex.Deadlock()
            case syntax.Call(name) if isinstance(function := scope.find(name), sc.FunctionSymbol):
                return self.functions.call(function, written, scope, self)
            case syntax.Call(name, given, span) if name in FUNCTIONS and not scope.find(name):
                self.fraction = self.fraction or span
                numbers = [self.expression(expression, scope) for expression in given]
                return operations.fractional_call(name, numbers, span)
            case syntax.Call(name, (body,), span) if (
                name in operations.LINEAR_WORDS and self.automata
            ):
                return operations.linear_of(name, self.expression(body, scope), span)
            case syntax.Name() | syntax.Index() | syntax.Member() | syntax.Call():
                if (location := self._location(written, scope)) is not None:
                    return location
                return symbols.value_of(self.symbol(written, scope), written.span)
            case syntax.Rate(_, span):
                fix = "write it in an invariant: x' == 2, alone or joined by &&"
                raise model_error("TA009", "the rate of a clock cannot be used here", span, fix)
            case syntax.Unary(op, operand, span):
                return operations.unary(op, self.expression(operand, scope), span)
            case syntax.Binary(op, left, right, span):
                if op in operations.COMPARISONS and (clocks := self._clock_compare(written, scope)):
                    return clocks
                if op in operations.SAMENESS and (whole := self._whole_compare(written, scope)):
                    return whole
                first = self.expression(left, scope)
                if first == ex.Constant(0) and op is ex.BinaryOp.AND:
                    return first  # the right side need not have a meaning then
                return operations.binary(op, first, self.expression(right, scope), span)
            case syntax.Conditional(condition, then, otherwise, span):
                test = self.expression(condition, scope)
                yes, no = self.expression(then, scope), self.expression(otherwise, scope)
                return operations.choice(test, yes, no, span)
            case syntax.Quantified(op, name, kind, body, span):
                values = symbols.values_of(self.type(kind, scope), kind.span)
                self.unrolled += len(values)
                if self.unrolled > MAX_UNROLLED:
                    message = f"quantifiers expand to more than {MAX_UNROLLED:,} conditions"
                    raise model_error("TA019", message, span, "let them range over smaller types")
                parts = [
                    self.expression(body, scope.inner({name: sc.ConstantSymbol(value)}))
                    for value in values
                ]
                return operations.joined(op, parts, span)
            case syntax.Path(op, body, bound, span, left):
                if not self.automata:
                    raise model_error("TA020", "only queries refer to runs", span)
                until = ex.TRUE if left is None else self.expression(left, scope)
                inner = self.expression(body, scope)
                return ex.PathFormula(op, inner, self.limit(bound, scope), until)
            case syntax.LeadsTo(_, _, _, span):
                message = "`-->` is only allowed at the outermost level"
                raise model_error("TA020", message, span, "write A[] (p imply A<> q)")
            case (
                syntax.Assuming()
                | syntax.Chance()
                | syntax.Mean()
                | syntax.Simulation()
                | syntax.Extremes()
            ):
                raise model_error("TA020", "only allowed at the outermost level", written.span)
            case _:
                assert_never(written)

    def condition(self, written: syntax.Expression, scope: sc.Scope) -> ex.Expression:
        """Resolve an expression that may not change anything."""
        condition = self.expression(written, scope)
        refuse_changes(condition, written.span)
        return condition

    def constant(self, written: syntax.Expression, scope: sc.Scope, *, real: bool = False) -> int:
        """The value of an expression that must be constant; if `real`, as bits."""
        value = self.expression(written, scope)
        value = operations.fitted(value, real, written.span)
        if not is_fixed(value):
            fix = "use numbers, `const` names, parameters, and functions of them only"
            raise model_error("TA006", "this is not constant", written.span, fix)
        return evaluator(value)((), ())

    def limit(self, written: syntax.Expression | None, scope: sc.Scope) -> int | None:
        """The bound of a path operator, in units of time; `None` if it has none."""
        if written is None:
            return None
        units = self.constant(written, scope)
        if not 0 <= units < ex.MAX_TIME:
            fix = f"bounds are from 0 to {ex.MAX_TIME - 1:,}"
            raise model_error("TA007", f"a bound of {units}", written.span, fix)
        return units

    def extents(self, sizes: Sequence[syntax.Size], scope: sc.Scope) -> tuple[range, ...]:
        """The index range of each dimension: below a number, or the values of a type."""
        return tuple(self._extent(size, scope) for size in sizes)

    def typed(
        self, item: syntax.Declaration | syntax.TypeDefinition | syntax.Parameter, scope: sc.Scope
    ) -> sc.ResolvedType:
        """The type of a declared thing, with its own dimensions before those of the type."""
        kind = self.type(item.type, scope)
        return replace(kind, extents=(*self.extents(item.sizes, scope), *kind.extents))

    def _extent(self, size: syntax.Size, scope: sc.Scope) -> range:
        if isinstance(size, syntax.TypeText):
            return symbols.values_of(self.type(size, scope), size.span)
        symbol = scope.find(size.name) if isinstance(size, syntax.Name) else None
        if isinstance(symbol, sc.TypeSymbol):
            return symbols.values_of(symbol.type, size.span)
        number = self.constant(size, scope)
        if number < 1:
            raise model_error("TA007", f"an array of {number} elements", size.span)
        symbols.check_size(number, size.span)
        return range(number)

    def type(self, written: syntax.TypeText, scope: sc.Scope) -> sc.ResolvedType:
        """The type with its range evaluated."""
        kind = self._plain_type(written, scope)
        return replace(
            kind,
            const=kind.const or written.const,
            broadcast=kind.broadcast or written.broadcast,
            urgent=kind.urgent or written.urgent,
        )

    def _plain_type(self, written: syntax.TypeText, scope: sc.Scope) -> sc.ResolvedType:
        """A type without its prefixes."""
        if written.base is ex.BaseType.NAMED:
            symbol = scope.find(written.name)
            if not isinstance(symbol, sc.TypeSymbol):
                if reason := type_reason(written.name):
                    raise model_error("TA016", reason[0], written.span, reason[1])
                types = [n for n in scope.names() if isinstance(scope.find(n), sc.TypeSymbol)]
                known = [*types, "int", "bool", "clock", "chan"]
                raise unknown("type named", written.name, written.span, known)
            return symbol.type
        if written.base is ex.BaseType.RECORD:
            fields = {}
            for part in written.fields:
                kind = self.type(part.type, scope)
                if part.name in fields:
                    raise model_error("TA003", f"two fields named `{part.name}`", part.span)
                sizes = self.extents(part.sizes, scope)
                fields[part.name] = replace(kind, extents=(*sizes, *kind.extents))
            return sc.ResolvedType(ex.BaseType.RECORD, fields=tuple(fields.items()))
        if written.base is ex.BaseType.DOUBLE:
            self.fraction = self.fraction or written.span
        if written.base is not ex.BaseType.INT:
            return sc.ResolvedType(written.base, 0, 1)
        if written.low is None or written.high is None:
            if not (self.open_ints or written.const):
                fix = "give its range: int[low, high]"
                raise model_error("TA005", "an int without a range", written.span, fix)
            limits = symbols.INT32 if written.const else symbols.INT16
            return sc.ResolvedType(ex.BaseType.INT, *limits)
        low, high = self.constant(written.low, scope), self.constant(written.high, scope)
        if low > high:
            raise model_error("TA007", f"the range [{low}, {high}] is empty", written.span)
        return sc.ResolvedType(ex.BaseType.INT, low, high)

    def symbol(self, written: syntax.Expression, scope: sc.Scope) -> sc.Symbol:
        """The symbol of a name, an element of an array or a member of a record."""
        match written:
            case syntax.Name(name, span):
                symbol = scope.find(name)
                if symbol is None and scope.names_automaton(name):
                    raise _no_value(span)
                if symbol is None and scope.declares(name):
                    raise refusal()  # the faulty declaration has been reported already
                if symbol is None:
                    known = [*scope.names(), *(n for n, _ in self.automata)]
                    raise unknown("name", name, span, known)
                return symbol
            case syntax.Index(base, index, span):
                position = self.expression(index, scope)
                operations.refuse_clocks(position, index.span)
                return symbols.element_of(self.symbol(base, scope), position, span)
            case syntax.Member(base, name, span) if whole := self._record(base, scope):
                if name not in (fields := dict(whole.fields)):
                    raise unknown("field", name, span, fields)
                return fields[name]
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
                refuse_foreign(name, span)
                names = [n for n in scope.names() if isinstance(scope.find(n), sc.FunctionSymbol)]
                raise unknown("function", name, span, names)
            case _:
                fix = "name a variable, a clock or a channel"
                raise model_error("TA004", "this is not a name", written.span, fix)

    def clock(self, written: syntax.Expression, scope: sc.Scope) -> int | None:
        """The clock that an expression names; `None` if it names none."""
        match self._named(written, scope):
            case sc.PlacedSymbol(ex.BaseType.CLOCK, slot):
                return symbols.clock_of(slot, written.span)
            case _:
                return None

    def _named(self, written: syntax.Expression, scope: sc.Scope) -> sc.Symbol | None:
        """The symbol that an expression names; `None` if it names none, or a location."""
        is_name = isinstance(written, syntax.Name | syntax.Index | syntax.Member)
        if not is_name or self._location(written, scope) is not None:
            return None
        return self.symbol(written, scope)

    def _clock_compare(self, written: syntax.Binary, scope: sc.Scope) -> ex.Expression | None:
        """Resolve a comparison with clocks; `None` if it has none."""
        terms = [*terms_of(written.left), *terms_of(written.right, -1)]
        named = [(sign, part, self.clock(part, scope)) for sign, part in terms]
        clocks = sorted((sign, clock) for sign, _, clock in named if clock is not None)
        op, span = written.op, written.span
        match clocks:
            case []:
                return None
            # A clock alone on its side may be compared with any number.
            case [(sign, clock)] if any(
                part in (written.left, written.right) for _, part, its in named if its is not None
            ):
                bound = self.expression(written.right if sign > 0 else written.left, scope)
                bound = operations.clock_number(bound)
                turned = op if sign > 0 else operations.MIRRORED[op]
                return operations.compare_clock(clock, turned, bound, span)
        # Otherwise the terms without clocks must be constant: they are moved to the right side.
        others = ((sign, part) for sign, part, clock in named if clock is None)
        number = -sum(sign * self.constant(part, scope) for sign, part in others)
        match clocks:
            case [(sign, clock)]:
                # -x < n is x > -n
                turned = op if sign > 0 else operations.MIRRORED[op]
                return operations.compare_clock(clock, turned, ex.Constant(sign * number), span)
            case [(-1, second), (1, first)] if first != second:
                return difference(self.diagonals, first, second, op, number, span)
            case _:
                fix = "compare one clock, or the difference of two, with a number"
                raise model_error("TA008", "a sum of clocks is compared", span, fix)

    def _whole_compare(self, written: syntax.Binary, scope: sc.Scope) -> ex.Expression | None:
        """Resolve a comparison of whole records or arrays; `None` if it is none."""
        left, right = self._named(written.left, scope), self._named(written.right, scope)
        if not (left and right and symbols.is_whole(left) and symbols.is_whole(right)):
            return None
        return operations.whole_compare(written.op, left, right, written.span)

    def _record(self, written: syntax.Expression, scope: sc.Scope) -> sc.RecordSymbol | None:
        """The record that an expression names; `None` if it names none."""
        match written:
            case syntax.Name(name):
                symbol = scope.find(name)
            case syntax.Index(base, index, span) if inner := self._record(base, scope):
                symbol = symbols.element_of(inner, self.expression(index, scope), span)
            case syntax.Member(base, name) if inner := self._record(base, scope):
                symbol = dict(inner.fields).get(name)
            case syntax.Member(syntax.Name() | syntax.Call() as base, name) if self.automata:
                symbol = self._automaton(base, scope).scope.symbols.get(name)
            case _:
                return None
        return symbol if isinstance(symbol, sc.RecordSymbol) else None

    def _location(self, written: syntax.Expression, scope: sc.Scope) -> ex.InLocation | None:
        if not isinstance(written, syntax.Member) or self._record(written.base, scope):
            return None
        automaton = self._automaton(written.base, scope)
        if written.name not in automaton.locations:
            return None
        return ex.InLocation(automaton.index, automaton.locations[written.name])

    def _automaton(self, written: syntax.Expression, scope: sc.Scope) -> sc.AutomatonSymbol:
        match written:
            case syntax.Name(name, span):
                key: sc.AutomatonKey = (name, ())
            case syntax.Call(name, arguments, span):
                key = (name, tuple(self.constant(a, scope) for a in arguments))
            case _:
                span = written.span
                key = ("", ())
        return symbols.automaton_at(self.automata, key, span)


def _no_value(span: Span) -> ModelError:
    fix = f"name a location: {span.text}.location"
    return model_error("TA004", "an automaton is not a value", span, fix)
