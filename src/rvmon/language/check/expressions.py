"""Checks expressions and turns them into formulas and quantities."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import ParamSpec, TypeVar, assert_never

from rvmon.diagnostics import Diagnostic, Span
from rvmon.language.check import scope as sc
from rvmon.language.check.comparisons import compared, formula_of, number_of, time_shifted
from rvmon.language.check.function_calls import applied
from rvmon.language.check.moving_windows import bound_of, bounded
from rvmon.language.check.quantities import arithmetic, closed_interval, for_each_outcome, ticks_of
from rvmon.language.checked import formula as rv
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.operators import Tense, Window
from rvmon.language.checked.specification import TimeModel
from rvmon.language.rules import Findings, Refusal, Reported
from rvmon.language.rules import names as name_rules
from rvmon.language.rules import requirements as requirement_rules
from rvmon.language.rules import types as rules
from rvmon.language.rules.syntax import Cost, Effort
from rvmon.language.syntax import expressions as ast
from rvmon.language.syntax.expressions import Window as WindowSyntax
from rvmon.language.syntax.items import ConstItem, DefineItem
from rvmon.units import PLAIN, UnknownUnitError, parse_unit

P = ParamSpec("P")
T = TypeVar("T")

NOW = "now"
"""The word for the time since the first instant; a declared name of that text takes precedence."""


class Checker:
    """Evaluates expressions to formulas or quantities, and records findings.

    `characters` is the length of the whole specification, on which the limit of work depends.

    A method that takes an expression reports the errors of *all* its operands before it raises.
    """

    def __init__(self, table: sc.Table, findings: Findings, characters: int) -> None:
        self.table = table
        self._findings = findings
        self.effort = Effort(characters)
        self._defined: dict[str, tuple[sc.Value | None, Cost]] = {}

    def report(self, finding: Diagnostic) -> None:
        """Record a finding.

        Raises:
            TooManyErrors: there are too many.
        """
        self._findings.add(finding)

    def top(self, expression: ast.Expression, scope: sc.Scope) -> rv.Formula | None:
        """A complete formula; `None` if it has an error, which is recorded."""
        self.effort.restart()
        return self.collected(self.formula, expression, scope)

    def collected(self, make: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T | None:
        """The result of `make`, or `None` if it raises a refusal, which is recorded."""
        try:
            return make(*args, **kwargs)
        except Refusal as refusal:
            self.report(refusal.finding)
        except Reported:
            pass
        return None

    def formula(self, expression: ast.Expression, scope: sc.Scope) -> rv.Formula:
        """The formula that the expression stands for.

        Raises:
            Refusal: it is a number or label.
            Reported: it has an error.
        """
        return formula_of(self.values((expression,), scope)[0], expression.span)

    def calculated(
        self, op: NumericOp, args: tuple[ast.Expression, ...], scope: sc.Scope, span: Span
    ) -> sc.Value:
        """The result of an operation on numbers, or on choices between numbers."""

        def calculate(values: Sequence[sc.Value]) -> sc.Value:
            if (instant := time_shifted(op, values)) is not None:
                return instant
            pairs = zip(values, args, strict=True)
            return arithmetic(op, [(number_of(v, e.span), e.span) for v, e in pairs], span)

        return for_each_outcome(self.values(args, scope), span, calculate)

    def values(self, expressions: tuple[ast.Expression, ...], scope: sc.Scope) -> list[sc.Value]:
        """The values that the expressions stand for.

        Raises:
            Reported: one has an error; the findings of all are recorded.
        """
        checked = [self.value(expression, scope) for expression in expressions]
        values = [value for value in checked if value is not None]
        if len(values) < len(checked):
            raise Reported
        return values

    def duration(self, expression: ast.Expression, scope: sc.Scope) -> int:
        """A constant duration in ticks.

        Raises:
            Refusal: it is not a constant duration.
            Reported: it has an error.
        """
        return ticks_of(self.values((expression,), scope)[0], expression.span)

    def value(self, expression: ast.Expression, scope: sc.Scope) -> sc.Value | None:
        """The value of the expression; `None` if it has an error, which is recorded."""
        try:
            self.effort.enter(expression.span)
            return self._value(expression, scope)
        except Refusal as refusal:
            self.report(refusal.finding)
        except Reported:
            pass
        finally:
            self.effort.leave()
        return None

    def _value(self, expression: ast.Expression, scope: sc.Scope) -> sc.Value:
        match expression:
            case ast.Group(inner=inner):
                return self._value(inner, scope)
            case ast.Number():
                return self._number(expression)
            case ast.Name():
                return self._name(expression, scope)
            case ast.Truth(value=value, span=span):
                return rv.Constant(value, span)
            case ast.Edge(bound=bound, span=span):
                return rv.BoundAtom(bound, span)
            case ast.Call():
                return self._call(expression, scope)
            case ast.Prefix():
                return self._prefix(expression, scope)
            case ast.Immediately(operand=operand):
                return self.formula(operand, scope)
            case ast.Infix():
                return self._infix(expression, scope)
            case ast.Comparison():
                return compared(self, expression, scope)
            case ast.Choice(condition=condition, chosen=chosen, otherwise=otherwise):
                sides = self.values((chosen, otherwise), scope)
                return sc.Chosen(self.formula(condition, scope), *sides)
            case ast.Operation(op=op, args=args, span=span):
                return self.calculated(op, args, scope, span)
            case ast.Path() | ast.Quantified() | ast.LeadsTo():
                raise Refusal(requirement_rules.path_outside(expression.span))
            case _:
                assert_never(expression)

    def _number(self, number: ast.Number) -> sc.Quantity:
        if number.value is None:
            raise Refusal(rules.out_of_range(number.span))
        try:
            unit = parse_unit(number.unit) if number.unit else PLAIN
        except UnknownUnitError as error:
            part = str(error)
            raise Refusal(rules.unknown_unit(number.span, part, sc.close_unit(part))) from None
        return sc.Quantity(constant=number.value, unit=unit)

    # Names.

    def known(self, name: str, scope: sc.Scope) -> bool:
        """Whether the name stands for anything but a label."""
        table = self.table
        return (
            name == NOW
            or name in scope.names
            or name in table.declared
            or table.field(name) is not None
        )

    def undeclared(self, expression: ast.Expression) -> list[ast.Name]:
        """The names in an expression that stand for nothing, not even for a label of a signal."""
        signals = self.table.signals.values()
        labels = {label for signal in signals for label in signal.type.labels}
        return [
            part
            for part in ast.expressions_in(expression)
            if isinstance(part, ast.Name)
            and not self.known(part.text, sc.EVERYWHERE)
            and part.text not in labels | self.table.doubtful
        ]

    def _name(self, name: ast.Name, scope: sc.Scope) -> sc.Value:
        local = scope.names.get(name.text)
        match local:
            case sc.Quantity() | sc.Moment():
                return local
            case sc.Closure(expression=expression, scope=outer):
                return self.values((expression,), outer)[0]
        declared = self.table.declared.get(name.text)
        if isinstance(declared, DefineItem | ConstItem):
            return self._defined_value(name, declared)
        return self._atom(name, scope)

    def _atom(self, name: ast.Name, scope: sc.Scope) -> sc.Value:
        table = self.table
        unit = table.units.get(name.text, PLAIN)
        if signal := table.signals.get(name.text):
            return sc.typed(rv.SignalValue(signal.name), signal.type, unit)
        if name.text in table.events:
            return rv.EventAtom(name.text, name.span)
        if field := table.field(name.text):
            return sc.typed(*field, unit)
        if name.text in table.declared or name.text in table.doubtful:
            raise Reported  # its declaration has an error, which is recorded
        if name.text == NOW:
            return sc.Now()
        close = sc.close_name(table, name.text, tuple(scope.names))
        raise Refusal(name_rules.unknown(name.span, name.text, close))

    def _defined_value(self, name: ast.Name, declared: DefineItem | ConstItem) -> sc.Value:
        """The value of a constant or a macro without parameters, evaluated once for all uses."""
        if isinstance(declared, DefineItem) and declared.parameters is not None:
            count = len(declared.parameters)
            raise Refusal(rules.argument_count(name.span, name.text, f"{count} argument(s)", 0))
        if name.text in self.table.recursive:
            raise Reported
        if name.text not in self._defined:
            mark = self.effort.mark()
            value = self._body_value(declared)
            self._defined[name.text] = value, self.effort.since(mark)
        body_value, cost = self._defined[name.text]
        if body_value is None:
            raise Reported
        # The value is shared, but later passes visit it once per use, so each use counts. In a
        # chain of macros that use the previous one twice, the work doubles with every macro.
        self.effort.add(cost, name.span)
        return body_value

    def _body_value(self, declared: DefineItem | ConstItem) -> sc.Value | None:
        if isinstance(declared, DefineItem):
            return self.value(declared.body, sc.EVERYWHERE)
        value = self.value(declared.value, sc.EVERYWHERE)
        if value is None or (isinstance(value, sc.Quantity) and value.constant is not None):
            return value
        self.report(rules.not_constant(declared.value.span))
        return None

    def _call(self, call: ast.Call, scope: sc.Scope) -> sc.Value:
        declared = self.table.declared.get(call.function.text)
        if not isinstance(declared, DefineItem) or declared.parameters is None:
            return applied(self, call, scope)
        parameters = [parameter.text for parameter in declared.parameters]
        if len(parameters) != len(call.args):
            takes = f"{len(parameters)} argument(s)"
            given = len(call.args)
            raise Refusal(rules.argument_count(call.span, call.function.text, takes, given))
        if call.function.text in self.table.recursive:
            raise Reported
        closures = (sc.Closure(arg, scope) for arg in call.args)
        inner = scope.inside(dict(zip(parameters, closures, strict=True)))
        return self.values((declared.body,), inner)[0]

    def unwrapped(
        self, expression: ast.Expression, scope: sc.Scope
    ) -> tuple[ast.Expression, sc.Scope]:
        """The expression without brackets, with macro parameters replaced by their arguments."""
        while True:
            match expression:
                case ast.Group(inner=inner):
                    expression = inner
                case ast.Name(text=text) if isinstance(
                    argument := scope.names.get(text), sc.Closure
                ):
                    expression, scope = argument.expression, argument.scope
                case _:
                    return expression, scope

    # Operators.

    def _prefix(self, prefix: ast.Prefix, scope: sc.Scope) -> rv.Formula:
        present = prefix.op.entry.tense is Tense.PRESENT
        # Both operand and window are checked before either raises, to show all findings.
        operand = self.value(prefix.operand, scope if present else scope.later())
        bound = bound_of(self, prefix.op, prefix.window, scope)
        if bound is None:
            interval = self._interval_of(prefix.op, prefix.window, prefix.op_span, scope)
        if operand is None:
            raise Reported
        required = formula_of(operand, prefix.operand.span)
        if bound is not None:
            return bounded(prefix.op, (required,), bound, prefix.span)
        return rv.Unary(prefix.op, required, interval, prefix.span)

    def _interval_of(
        self, op: rv.UnaryOp, window: WindowSyntax | None, span: Span, scope: sc.Scope
    ) -> rv.Interval | None:
        if op.entry.tense is Tense.PRESENT:
            return None
        if op.entry.window is Window.NONE:
            if self.table.time is TimeModel.HELD:
                if op.entry.tense is Tense.PAST:
                    raise Refusal(rules.step_back_in_held_time(span.text, span))
                raise Refusal(rules.step_in_held_time(span.text, span))
            if window is not None:
                raise Refusal(rules.no_window(span.text, window.span))
            return None
        return self.interval(window, scope)

    def _infix(self, infix: ast.Infix, scope: sc.Scope) -> rv.Formula:
        present = infix.op.entry.window is Window.NONE
        inner = scope if present else scope.later()
        operands = [self.value(side, inner) for side in (infix.left, infix.right)]
        interval = None
        bound = bound_of(self, infix.op, infix.window, scope)
        if bound is None and not present:
            interval = self.interval(infix.window, scope)
            from_now = infix.op.entry.window is Window.FROM_NOW
            if from_now and interval.low > 0 and infix.window is not None:
                raise Refusal(rules.late_weak_window(infix.op_span.text, infix.window.span))
        left, right = operands
        if left is None or right is None:
            raise Reported
        sides = formula_of(left, infix.left.span), formula_of(right, infix.right.span)
        if bound is not None:
            return bounded(infix.op, sides, bound, infix.span)
        return rv.Binary(infix.op, *sides, interval, infix.span)

    def interval(self, window: WindowSyntax | None, scope: sc.Scope) -> rv.Interval:
        """The closed interval of a window in ticks; `None` is `[0, ∞)`.

        Raises:
            Refusal: a bound is not a duration, or no tick lies in the window.
            Reported: a bound has an error.
        """
        if window is None:
            return rv.Interval()
        low = 0 if window.low is None else self.duration(window.low, scope)
        high = None if window.high is None else self.duration(window.high, scope)
        if window.low and window.high and high is not None and high < low:
            raise Refusal(rules.reversed_bounds(window.span, window.low.span, window.high.span))
        opens = {"low_open": window.low_open, "high_open": window.high_open}
        return closed_interval(low, high, **opens, span=window.span)
