"""What can be done with a name: take its value, an element of it, the clock that it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import assert_never

from rvmon.diagnostics import Span
from rvmon.texts import did_you_mean
from rvmon.timed.model.arithmetic import check_index
from rvmon.timed.model.expressions import (
    Constant,
    Expression,
    Fractional,
    Lookup,
    Slot,
    VariableValue,
)
from rvmon.timed.model.operators import BaseType
from rvmon.timed.model.rules import model_error
from rvmon.timed.model.scope import (
    AutomatonKey,
    AutomatonSymbol,
    ChosenSymbol,
    ConstantSymbol,
    ConstantValue,
    FunctionSymbol,
    PlacedSymbol,
    RecordSymbol,
    Symbol,
    TypeSymbol,
)


def value_of(symbol: Symbol, span: Span) -> Expression:
    """The value that a symbol has in an expression.

    Raises:
        ModelError: it has none: a clock, an array, a channel or a type.
    """
    match symbol:
        case ConstantSymbol(int(value), _, is_real):
            return Fractional("=", (Constant(value),)) if is_real else Constant(value)
        case PlacedSymbol(BaseType.INT, slot) if symbol.is_single:
            return VariableValue(replace(slot, span=span))
        case ChosenSymbol(values, slot) if len(slot.indices) == len(slot.extents):
            return Lookup(values, replace(slot, span=span))
        case PlacedSymbol(BaseType.CLOCK):
            fix = "a clock can only be compared with a number, or be set"
            raise model_error("TA009", "a clock has no value here", span, fix)
        case PlacedSymbol(BaseType.INT) | ConstantSymbol() | ChosenSymbol():
            raise model_error("TA004", "an array is no value", span, "give an index")
        case RecordSymbol(fields):
            fix = f"name a field, such as {span.text}.{fields[0][0]}"
            raise model_error("TA004", "a record is no value", span, fix)
        case FunctionSymbol():
            raise model_error("TA004", "a function is no value", span, f"call it: {span.text}(…)")
        case PlacedSymbol() | TypeSymbol():
            fix = "channels stand in synchronisations, types in declarations"
            raise model_error("TA004", f"`{span.text}` is no value", span, fix)
        case _:
            assert_never(symbol)


def element_of(symbol: Symbol, index: Expression, span: Span) -> Symbol:
    """An element of an array.

    Raises:
        ModelError: the symbol is no array, or the index is outside it.
    """
    match symbol:
        case ConstantSymbol(tuple() as values, (extent, *inner)):
            if not isinstance(index, Constant) or index.value not in extent:
                slot = Slot(0, (extent, *inner), (index,), span)
                return ChosenSymbol(tuple(flat(values)), slot)
            return ConstantSymbol(values[index.value - extent.start], tuple(inner))
        case PlacedSymbol(_, slot) | ChosenSymbol(_, slot):
            return replace(symbol, slot=_deeper(slot, index, span))
        case RecordSymbol(fields):
            return RecordSymbol(tuple((name, element_of(s, index, span)) for name, s in fields))
        case ConstantSymbol() | TypeSymbol() | FunctionSymbol():
            raise model_error("TA004", "this is no array", span)
        case _:
            assert_never(symbol)


def flat(value: ConstantValue) -> list[int]:
    """The numbers of a constant, those of the last index side by side."""
    if isinstance(value, int):
        return [value]
    return [number for item in value for number in flat(item)]


def is_whole(symbol: Symbol) -> bool:
    """Whether a symbol is an array or record that holds numbers, not one of them."""
    match symbol:
        case RecordSymbol():
            return True
        case PlacedSymbol(BaseType.INT, slot) | ChosenSymbol(_, slot):
            return len(slot.indices) < len(slot.extents)
        case ConstantSymbol(value):
            return isinstance(value, tuple)
        case _:
            return False


def is_alike(one: Symbol, other: Symbol) -> bool:
    """Whether two arrays or records have the same parts."""
    if isinstance(one, RecordSymbol) and isinstance(other, RecordSymbol):
        return [name for name, _ in one.fields] == [name for name, _ in other.fields] and all(
            is_alike(a, b) for (_, a), (_, b) in zip(one.fields, other.fields, strict=True)
        )
    records = isinstance(one, RecordSymbol) or isinstance(other, RecordSymbol)
    return not records and len(leaves(one)) == len(leaves(other))


def leaves(symbol: Symbol) -> list[Symbol]:
    """The single things of an array or record, in order."""
    match symbol:
        case RecordSymbol(fields):
            return [leaf for _, inner in fields for leaf in leaves(inner)]
        case ConstantSymbol(tuple() as values, (_, *inner)):
            return [leaf for v in values for leaf in leaves(ConstantSymbol(v, tuple(inner)))]
        case PlacedSymbol(_, slot) | ChosenSymbol(_, slot) if len(slot.indices) < len(slot.extents):
            extent = slot.extents[len(slot.indices)]
            deeper = (settle(replace(slot, indices=(*slot.indices, Constant(i)))) for i in extent)
            return [leaf for one in deeper for leaf in leaves(replace(symbol, slot=one))]
        case _:
            return [symbol]


def _deeper(slot: Slot, index: Expression, span: Span) -> Slot:
    if len(slot.indices) == len(slot.extents):
        raise model_error("TA004", "more indices than the array has dimensions", span)
    return settle(Slot(slot.first, slot.extents, (*slot.indices, index), span))


def settle(slot: Slot) -> Slot:
    """The same slot without its array, if its indices are constant and complete."""
    if len(slot.indices) < len(slot.extents):
        return slot
    offset = 0
    for extent, index in zip(slot.extents, slot.indices, strict=True):
        if not isinstance(index, Constant) or index.value not in extent:
            return slot  # a run that comes to an index outside the array has no meaning
        offset = offset * len(extent) + index.value - extent.start
    return Slot(slot.first + offset, (), (), slot.span)


def clock_of(slot: Slot, span: Span) -> int:
    """The index of the clock that a slot names.

    Raises:
        ModelError: the variables would have to choose it, or it is an array.
    """
    for extent, index in zip(slot.extents, slot.indices, strict=False):
        if isinstance(index, Constant):
            check_index(index.value, extent, span)
    if slot.extents:
        missing = len(slot.indices) < len(slot.extents)
        message = "an array of clocks" if missing else "the index of a clock is not constant"
        raise model_error("TA006", message, span, "use a number or a parameter as index")
    return slot.first


def automaton_at(
    automata: Mapping[AutomatonKey, AutomatonSymbol], key: AutomatonKey, span: Span
) -> AutomatonSymbol:
    """The automaton of a name and arguments.

    Raises:
        ModelError: there is none, or none can be seen from where it is named.
    """
    if not automata:
        message = f"edges and invariants do not see the locations of `{span.text}`"
        fix = "only queries do: set a variable where it is entered and left, and read that"
        raise model_error("TA002", message, span, fix)
    if key not in automata:
        fix = did_you_mean(key[0], sorted({name for name, _ in automata}))
        raise model_error("TA002", f"no automaton `{span.text}`", span, fix)
    return automata[key]
