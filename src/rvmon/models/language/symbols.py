"""Symbols: the meaning of names, the layout of arrays and records, and operations on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Sized
from dataclasses import replace
from math import prod
from typing import Any, Protocol, assert_never

from rvmon.diagnostics import Label, Span
from rvmon.models import model_error
from rvmon.models.language import syntax
from rvmon.models.network import expressions as ex
from rvmon.models.network import scope as sc
from rvmon.models.network.evaluate import check_index
from rvmon.models.network.fractions import marked
from rvmon.texts import counted, did_you_mean

MAX_VALUES = 10_000
"""Limit for the number of values of a quantifier, a `select`, a parameter or an array."""

INT16 = (-32768, 32767)  # the range of UPPAAL's `int` without a range
INT32 = (-(1 << 31), (1 << 31) - 1)  # the range of an integer constant declared without one
Extents = tuple[range, ...]  # the index range of each dimension of an array, outermost first

Value = sc.ConstantValue | None
"""An initial value: a tuple with one value per part for an array or record; `None` if absent."""


class Placer(Protocol):
    """Assigns slots to declared things."""

    def place(self, kind: sc.ResolvedType, names: Sequence[str], value: Value) -> int:
        """Reserve adjacent slots for things of one type; return the first."""
        ...


def laid_out(
    kind: sc.ResolvedType,
    names: Sequence[str],
    value: Value,
    placer: Placer,
    unnamed: Extents | None = None,
) -> sc.Symbol:
    """Lay out a declared thing and return its symbol. Fields of a record follow each other.

    `unnamed` are the last dimensions, whose indices the names do not contain yet; default: all.
    """
    suffixes = _suffixes(kind.extents if unnamed is None else unnamed)
    names = [name + suffix for name in names for suffix in suffixes]
    if kind.base is not ex.BaseType.RECORD:
        real = kind.base is ex.BaseType.DOUBLE
        if kind.const and isinstance(value, int):
            return sc.ConstantSymbol(value, real)
        if kind.const and value is not None and not real:
            return ex.Lookup(tuple(flat(value)), ex.Slot(0, kind.extents))
        slot = ex.Slot(placer.place(kind, names, value), kind.extents)
        return sc.PlacedSymbol(kind.placed_as, slot, real)
    fields = []
    for place, (field, written) in enumerate(kind.fields):
        whole = (*kind.extents, *written.extents)
        own = replace(written, const=kind.const or written.const, extents=whole)
        inner = None if value is None else _field(value, len(kind.extents), place)
        called = [f"{name}.{field}" for name in names]
        fields.append((field, laid_out(own, called, inner, placer, written.extents)))
    return sc.RecordSymbol(tuple(fields))


def _field(value: sc.ConstantValue, depth: int, place: int) -> sc.ConstantValue:
    """The values of one field, for all elements of an array of records."""
    assert isinstance(value, tuple), "a record's value has parts"
    if depth == 0:
        return value[place]
    return tuple(_field(element, depth - 1, place) for element in value)


def _suffixes(extents: Extents) -> list[str]:
    """The indices of all elements of an array, such as `[0]`; one empty text for a scalar."""
    if not extents:
        return [""]
    return [f"[{i}]{rest}" for i in extents[0] for rest in _suffixes(extents[1:])]


def variable_of(kind: sc.ResolvedType, name: str, initial: int) -> ex.Variable:
    """Make a variable of a type."""
    is_bool, is_real = kind.base is ex.BaseType.BOOL, kind.base is ex.BaseType.DOUBLE
    return ex.Variable(name, kind.low, kind.high, initial, is_bool, is_real)


def default_of(kind: sc.ResolvedType) -> int:
    """The initial value of a variable that is declared without one."""
    return 0 if kind.low <= 0 <= kind.high else kind.low


def count_of(kind: sc.ResolvedType) -> int:
    """The number of scalars in an array or record of a type."""
    each = sum(count_of(field) for _, field in kind.fields) if kind.fields else 1
    return prod(map(len, kind.extents)) * each


def parts_of_initial(
    written: syntax.Initial, kind: sc.ResolvedType
) -> list[tuple[syntax.Initial, sc.ResolvedType]] | None:
    """The values for the parts of an array or record, with their types; `None` for a scalar."""
    if not isinstance(written, syntax.Values):
        if kind.extents or kind.fields:
            fix = "write {a, b, …}"
            raise model_error("TA004", "an array needs a list of values", written.span, fix)
        return None
    if kind.extents:
        expected = [replace(kind, extents=kind.extents[1:])] * len(kind.extents[0])
    else:
        expected = [field for _, field in kind.fields]
    if len(expected) != len(written.items):
        count = f"{len(expected)} values" if expected else "one value"
        message = f"{count} expected, {len(written.items)} found"
        raise model_error("TA004", message, written.span)
    return list(zip(written.items, expected, strict=True))


def check_size(elements: int, span: Span) -> None:
    """Refuse an array with too many elements."""
    if elements > MAX_VALUES:
        raise model_error("TA019", f"an array of more than {MAX_VALUES:,} elements", span)


def check_range(value: int, kind: sc.ResolvedType, span: Span) -> None:
    """Refuse a constant outside the range of its type."""
    if kind.base in (ex.BaseType.INT, ex.BaseType.BOOL) and not kind.low <= value <= kind.high:
        raise model_error("TA007", f"{value} is outside [{kind.low}, {kind.high}]", span)


def values_of(kind: sc.ResolvedType, span: Span) -> range:
    """All values of a finite type."""
    if kind.base not in (ex.BaseType.INT, ex.BaseType.BOOL):
        raise model_error("TA004", "only int and bool types can be enumerated", span)
    if kind.high - kind.low >= MAX_VALUES:
        fix = "give a small range: int[low, high]"
        raise model_error("TA019", f"more than {MAX_VALUES:,} values", span, fix)
    return range(kind.low, kind.high + 1)


def check_count(name: str, parameters: Sized, arguments: Sized, span: Span) -> None:
    """Refuse a wrong number of arguments."""
    count = len(parameters)
    if count != len(arguments):
        message = f"`{name}` takes {counted(count, 'argument')}, {len(arguments)} given"
        raise model_error("TA015", message, span)


def claim(name: str, span: Span, scope: sc.Scope) -> None:
    """Record the place of a declaration; refuse a name that its level already has."""
    if name in scope.places:
        first = Label(scope.places[name], "first declared here")
        raise model_error("TA003", f"two things named `{name}`", span, "rename one", others=[first])
    scope.places[name] = span


class Calls(Placer, Protocol):
    """Functions that can be called, and slots for their locals (see `functions.Functions`)."""

    def call(
        self, symbol: sc.FunctionSymbol, written: syntax.Call, scope: sc.Scope, resolver: Any
    ) -> ex.Expression:
        """Make the expression for a call."""
        ...

    def variable(self, place: int) -> ex.Variable:
        """The variable with a slot."""
        ...


def value_of(symbol: sc.Symbol, span: Span) -> ex.Expression:
    """The value of a symbol as an expression."""
    match symbol:
        case sc.ConstantSymbol(value, is_real):
            return marked(ex.Constant(value), is_real)
        case sc.PlacedSymbol(ex.BaseType.INT, slot, is_real) if slot.is_single:
            return marked(ex.VariableValue(replace(slot, span=span)), is_real)
        case ex.Lookup(values, slot) if slot.is_single:
            return ex.Lookup(values, replace(slot, span=span))
        case sc.PlacedSymbol(ex.BaseType.CLOCK):
            fix = "a clock can only be compared with a number, or be set"
            raise model_error("TA009", "a clock has no value here", span, fix)
        case sc.PlacedSymbol(ex.BaseType.INT) | ex.Lookup():
            raise model_error("TA004", "an array is not a value", span, "give an index")
        case sc.RecordSymbol(fields):
            fix = f"name a field, such as {span.text}.{fields[0][0]}"
            raise model_error("TA004", "a record is not a value", span, fix)
        case sc.FunctionSymbol():
            raise model_error(
                "TA004", "a function is not a value", span, f"call it: {span.text}(…)"
            )
        case sc.PlacedSymbol() | sc.TypeSymbol():
            fix = "channels belong in synchronisations, types in declarations"
            raise model_error("TA004", f"`{span.text}` is not a value", span, fix)
        case _:
            assert_never(symbol)


def element_of(symbol: sc.Symbol, index: ex.Expression, span: Span | None) -> sc.Symbol:
    """The symbol of an element of an array."""
    match symbol:
        case ex.Lookup(values, ex.Slot(_, (extent, *inner), ())) if (
            isinstance(index, ex.Constant) and index.value in extent
        ):
            size, place = len(values) // len(extent), index.value - extent.start
            own = values[place * size : (place + 1) * size]
            return ex.Lookup(own, ex.Slot(0, tuple(inner))) if inner else sc.ConstantSymbol(own[0])
        case sc.PlacedSymbol(_, slot) | ex.Lookup(_, slot):
            if slot.is_single:
                raise model_error("TA004", "more indices than the array has dimensions", span)
            deeper = ex.Slot(slot.first, slot.extents, (*slot.indices, index), span)
            return replace(symbol, slot=settle(deeper))
        case sc.RecordSymbol(fields):
            return sc.RecordSymbol(tuple((name, element_of(s, index, span)) for name, s in fields))
        case sc.ConstantSymbol() | sc.TypeSymbol() | sc.FunctionSymbol():
            raise model_error("TA004", "this is not an array", span)
        case _:
            assert_never(symbol)


def flat(value: sc.ConstantValue) -> list[int]:
    """The numbers of a constant in order; the last index varies fastest."""
    if isinstance(value, int):
        return [value]
    return [number for item in value for number in flat(item)]


def is_whole(symbol: sc.Symbol) -> bool:
    """Whether a symbol is a whole array or record of numbers."""
    match symbol:
        case sc.RecordSymbol():
            return True
        case sc.PlacedSymbol(ex.BaseType.INT, slot) | ex.Lookup(_, slot):
            return not slot.is_single
        case _:
            return False


def is_alike(one: sc.Symbol, other: sc.Symbol) -> bool:
    """Whether two arrays or records have the same shape."""
    if isinstance(one, sc.RecordSymbol) and isinstance(other, sc.RecordSymbol):
        return [name for name, _ in one.fields] == [name for name, _ in other.fields] and all(
            is_alike(a, b) for (_, a), (_, b) in zip(one.fields, other.fields, strict=True)
        )
    records = isinstance(one, sc.RecordSymbol) or isinstance(other, sc.RecordSymbol)
    return not records and len(leaves(one)) == len(leaves(other))


def leaves(symbol: sc.Symbol) -> list[sc.Symbol]:
    """The scalars of an array or record, in order."""
    match symbol:
        case sc.RecordSymbol(fields):
            return [leaf for _, inner in fields for leaf in leaves(inner)]
        case sc.PlacedSymbol(_, slot) | ex.Lookup(_, slot) if not slot.is_single:
            indices = map(ex.Constant, slot.extents[len(slot.indices)])
            elements = (element_of(symbol, index, slot.span) for index in indices)
            return [leaf for element in elements for leaf in leaves(element)]
        case _:
            return [symbol]


def settle(slot: ex.Slot) -> ex.Slot:
    """The slot of the element itself, if all indices are there and constant; else unchanged."""
    if not slot.is_single:
        return slot
    offset = 0
    for extent, index in zip(slot.extents, slot.indices, strict=True):
        if not isinstance(index, ex.Constant) or index.value not in extent:
            return slot  # a run that evaluates an index outside the array is an error
        offset = offset * len(extent) + index.value - extent.start
    return ex.Slot(slot.first + offset, (), (), slot.span)


def clock_of(slot: ex.Slot, span: Span) -> int:
    """The index of the clock that a slot denotes."""
    for extent, index in zip(slot.extents, slot.indices, strict=False):
        if isinstance(index, ex.Constant):
            check_index(index.value, extent, span)
    if slot.extents:
        message = "the index of a clock is not constant" if slot.is_single else "an array of clocks"
        raise model_error("TA006", message, span, "use a number or a parameter as index")
    return slot.first


def automaton_at(
    automata: Mapping[sc.AutomatonKey, sc.AutomatonSymbol], key: sc.AutomatonKey, span: Span
) -> sc.AutomatonSymbol:
    """The automaton with a name and arguments."""
    if not automata:
        message = f"edges and invariants do not see the locations of `{span.text}`"
        fix = "only queries do: set a variable where it is entered and left, and read that"
        raise model_error("TA002", message, span, fix)
    if key not in automata:
        names = sorted({name for name, _ in automata})
        listed = ", ".join(names[:12]) + ", …" * (len(names) > 12)
        fix = did_you_mean(key[0], names, f"there are {listed}")
        raise model_error("TA002", f"no automaton `{span.text}`", span, fix)
    return automata[key]
