"""Functions of a model, specialised for the things that calls pass by reference.

All calls with the same references share one function.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models.language import symbols, syntax
from rvmon.models.language.operations import fitted
from rvmon.models.language.resolve import Resolver
from rvmon.models.language.statements import Bodies, number
from rvmon.models.network import expressions as ex
from rvmon.models.network import scope as sc
from rvmon.models.network.fractions import marked
from rvmon.models.network.guards import parts_in

MAX_LOCALS = 100_000  # limit for parameters and local variables of all functions together

_NOTHING = sc.ResolvedType(ex.BaseType.INT, 0, 0)
"""The result type of a function that returns nothing."""

_CHOSEN = ex.InLocation(-1, -1)
"""Stands for a non-constant index in the key of a specialised function."""


@dataclass(slots=True)
class Functions:
    """The functions called so far, and the slots that they use."""

    # variables of the network declared so far
    variables: list[ex.Variable] = field(default_factory=list)
    locals: list[ex.Variable] = field(default_factory=list)  # the first has slot −1
    # by the text of the function, its scope, and the things bound to its parameters
    functions: dict[tuple[object, ...], ex.Function] = field(default_factory=dict)
    # functions under construction, to detect recursion
    open: set[tuple[object, ...]] = field(default_factory=set)

    def place(self, kind: sc.ResolvedType, names: Sequence[str], value: symbols.Value) -> int:
        """Reserve slots for parameters or local variables; return the first."""
        del value  # these variables are set whenever the function runs
        self.locals += [
            symbols.variable_of(kind, name, symbols.default_of(kind)) for name in reversed(names)
        ]
        if len(self.locals) > MAX_LOCALS:
            raise model_error("TA019", f"more than {MAX_LOCALS:,} local variables", None)
        return -len(self.locals)

    def variable(self, place: int) -> ex.Variable:
        """The variable at a place."""
        return self.variables[place] if place >= 0 else self.locals[-place - 1]

    def call(
        self, symbol: sc.FunctionSymbol, written: syntax.Call, scope: sc.Scope, resolver: Resolver
    ) -> ex.Expression:
        """Make the expression for a call."""
        text: syntax.FunctionText = symbol.written
        symbols.check_count(text.name, text.parameters, written.arguments, written.span)
        bound: list[sc.Symbol | None] = []
        values: list[ex.Expression] = []
        chosen: list[ex.Expression] = []
        for parameter, argument in zip(text.parameters, written.arguments, strict=True):
            kind = resolver.typed(parameter, symbol.scope)
            is_single = not (kind.extents or kind.fields)
            # Whether the parameter stands for the argument itself instead of its value.
            is_bound = kind.placed_as is not ex.BaseType.INT or (
                parameter.reference and not (kind.const and is_single)
            )
            bound.append(None)
            if is_single and not is_bound:
                value = number(argument, scope, resolver)
                real = kind.base is ex.BaseType.DOUBLE
                values.append(fitted(value, real, argument.span))
                continue
            thing = resolver.symbol(argument, scope)
            _check_fit(thing, kind, parameter, argument.span)
            if is_bound:
                bound[-1] = _with_slots(thing, lambda slot: _without_choice(slot, chosen))
            else:
                values += [symbols.value_of(leaf, argument.span) for leaf in symbols.leaves(thing)]
        key = (id(text), id(symbol.scope), *bound)
        function = self.functions.get(key)
        if function is None:
            if key in self.open:
                fix = "write a loop"
                message = f"`{text.name}` calls itself"
                raise model_error("TA016", message, written.span, fix)
            self.open.add(key)
            try:
                function = self.functions[key] = self._make(text, symbol.scope, bound, resolver)
            finally:
                self.open.discard(key)
        called = ex.Invoke(function, (*values, *chosen), written.span)
        return marked(called, function.result[1].is_real)

    def _make(
        self,
        text: syntax.FunctionText,
        scope: sc.Scope,
        bound: Sequence[sc.Symbol | None],
        resolver: Resolver,
    ) -> ex.Function:
        """Make a function; parameters without a bound symbol get slots of their own."""
        inner, taken = sc.Scope(scope), sc.Scope()
        parameters: list[int] = []
        indices: list[int] = []

        def chosen(slot: ex.Slot) -> ex.Slot:
            """The slot with parameters in place of the indices that calls choose."""
            own: list[ex.Expression] = []
            for index, extent in zip(slot.indices, slot.extents, strict=False):
                if index == _CHOSEN:
                    kind = sc.ResolvedType(ex.BaseType.INT, extent.start, extent.stop - 1)
                    indices.append(self.place(kind, ["index"], None))
                    index = ex.VariableValue(ex.Slot(indices[-1]))
                own.append(index)
            return replace(slot, indices=tuple(own))

        for parameter, thing in zip(text.parameters, bound, strict=True):
            symbols.claim(parameter.name, parameter.span, taken)
            if thing is not None:
                inner.symbols[parameter.name] = _with_slots(thing, chosen)
                continue
            called = [f"{text.name}.{parameter.name}"]
            symbol = symbols.laid_out(resolver.typed(parameter, scope), called, None, self)
            inner.symbols[parameter.name] = symbol
            leaves = symbols.leaves(symbol)
            parameters += [leaf.slot.first for leaf in leaves if isinstance(leaf, sc.PlacedSymbol)]
        result = _NOTHING if text.type is None else resolver.type(text.type, scope)
        if result.extents or result.fields or result.placed_as is not ex.BaseType.INT:
            fix = "let it set a parameter that is passed by reference"
            message = f"`{text.name}` returns an array or record"
            raise model_error("TA016", message, text.span, fix)
        place = self.place(result, [f"{text.name}(…)"], None)
        body, continues = Bodies(text, resolver).statements(text.body.statements, inner)
        if continues:
            missing = ex.Missing(text.name, text.span)
            body.append(ex.Return(ex.Constant(0)) if text.type is None else missing)
        slots = [*parameters, *indices]
        return ex.Function(
            text.name, tuple((slot, self.variable(slot)) for slot in slots),
            (place, self.variable(place)), tuple(body), len(self.locals), _changes(body),
        )  # fmt: skip


def _check_fit(
    thing: sc.Symbol,
    kind: sc.ResolvedType,
    parameter: syntax.Parameter,
    span: Span,
) -> None:
    single = symbols.leaves(thing)
    own, is_real = ex.BaseType.INT, False
    if isinstance(single[0], sc.PlacedSymbol):
        own, is_real = single[0].kind, single[0].is_real
    if (
        own is not kind.placed_as
        or len(single) != symbols.count_of(kind)
        or (not kind.fields and is_real != (kind.base is ex.BaseType.DOUBLE))
    ):
        fix = f"`{parameter.name}` is declared as {parameter.type.span.text}"
        raise model_error("TA015", "this argument is of the wrong kind", span, fix)


def _with_slots(symbol: sc.Symbol, change: Callable[[ex.Slot], ex.Slot]) -> sc.Symbol:
    match symbol:
        case sc.RecordSymbol(fields):
            return sc.RecordSymbol(tuple((name, _with_slots(s, change)) for name, s in fields))
        case sc.PlacedSymbol(_, slot) | ex.Lookup(_, slot):
            return replace(symbol, slot=change(slot))
        case _:
            return symbol


def _without_choice(slot: ex.Slot, chosen: list[ex.Expression]) -> ex.Slot:
    """Replace each index of a slot that is not constant by a mark, and collect it in `chosen`."""
    indices: list[ex.Expression] = []
    for index in slot.indices:
        if not isinstance(index, ex.Constant):
            chosen.append(index)
        indices.append(index if isinstance(index, ex.Constant) else _CHOSEN)
    return replace(slot, indices=tuple(indices), span=None)


def _changes(body: Sequence[ex.Statement]) -> bool:
    """Whether statements set a clock or a variable outside the function."""
    return any(
        isinstance(one, ex.Reset) or (isinstance(one, ex.Assignment) and one.slot.first >= 0)
        for one in ex.statements_in(body)
    ) or any(isinstance(one, ex.Invoke) and one.function.changes for one in parts_in(body))
