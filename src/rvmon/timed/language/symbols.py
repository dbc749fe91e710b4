"""What can be done with a name: take its value, an element of it, the clock that it is."""

from __future__ import annotations

from dataclasses import replace
from typing import assert_never

from rvmon.diagnostics import Span
from rvmon.timed.model.evaluate import check_index
from rvmon.timed.model.expressions import Constant, Expression, Lookup, Slot, VariableValue
from rvmon.timed.model.rules import model_error
from rvmon.timed.model.scope import (
    ChannelSymbol,
    ChosenSymbol,
    ClockSymbol,
    ConstantSymbol,
    ConstantValue,
    Symbol,
    TypeSymbol,
    VariableSymbol,
)


def value_of(symbol: Symbol, span: Span) -> Expression:
    """The value that a symbol has in an expression.

    Raises:
        ModelError: it has none: a clock, an array, a channel or a type.
    """
    match symbol:
        case ConstantSymbol(int(value), _):
            return Constant(value)
        case VariableSymbol(slot) if len(slot.indices) == len(slot.extents):
            return VariableValue(replace(slot, span=span))
        case ChosenSymbol(values, extent, index):
            return Lookup(values, extent, index, span)
        case ClockSymbol():
            fix = "a clock can only be compared with a number, or be set"
            raise model_error("TA009", "a clock has no value here", span, fix)
        case VariableSymbol() | ConstantSymbol():
            raise model_error("TA004", "an array is no value", span, "give an index")
        case ChannelSymbol() | TypeSymbol():
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
            if not isinstance(index, Constant):
                return ChosenSymbol(_flat(values, span), extent, index)
            check_index(index.value, extent, span)
            return ConstantSymbol(values[index.value - extent.start], tuple(inner))
        case VariableSymbol(slot):
            return VariableSymbol(_deeper(slot, index, span))
        case ClockSymbol(slot):
            return ClockSymbol(_deeper(slot, index, span))
        case ChannelSymbol(slot):
            return ChannelSymbol(_deeper(slot, index, span))
        case ConstantSymbol() | TypeSymbol() | ChosenSymbol():
            raise model_error("TA004", "this is no array", span)
        case _:
            assert_never(symbol)


def _flat(values: tuple[ConstantValue, ...], span: Span) -> tuple[int, ...]:
    numbers = tuple(value for value in values if isinstance(value, int))
    if len(numbers) < len(values):
        raise model_error("TA006", "this index of a nested array is not constant", span)
    return numbers


def _deeper(slot: Slot, index: Expression, span: Span) -> Slot:
    if len(slot.indices) == len(slot.extents):
        raise model_error("TA004", "more indices than the array has dimensions", span)
    if isinstance(index, Constant):
        check_index(index.value, slot.extents[len(slot.indices)], span)
    return settle(Slot(slot.first, slot.extents, (*slot.indices, index), span))


def settle(slot: Slot) -> Slot:
    """The same slot without its array, if its indices are constant and complete."""
    if len(slot.indices) < len(slot.extents):
        return slot
    offset = 0
    for extent, index in zip(slot.extents, slot.indices, strict=True):
        if not isinstance(index, Constant):
            return slot
        offset = offset * len(extent) + index.value - extent.start
    return Slot(slot.first + offset, (), (), slot.span)


def clock_of(slot: Slot, span: Span) -> int:
    """The index of the clock that a slot names.

    Raises:
        ModelError: the variables would have to choose it, or it is an array.
    """
    if slot.extents:
        missing = len(slot.indices) < len(slot.extents)
        message = "an array of clocks" if missing else "the index of a clock is not constant"
        raise model_error("TA006", message, span, "use a number or a parameter as index")
    return slot.first
