"""The numbers that clocks are compared with before they are next reset, per location.

Source: Behrmann, Bouyer, Fleury, Larsen, Static Guard Analysis in Timed Automata Verification,
TACAS 2003; lower and upper bounds apart as in Behrmann et al., Lower and Upper Bounds in Zone-Based
Abstractions of Timed Automata, 2006.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf

from rvmon.timed.model.expressions import (
    BinaryOperation,
    Choice,
    ClockCompare,
    ClockOp,
    Constant,
    Expression,
    InLocation,
    Invoke,
    Lookup,
    Reset,
    UnaryOperation,
    VariableValue,
)
from rvmon.timed.model.network import Automaton, Edge, Network
from rvmon.timed.model.operators import BinaryOp, UnaryOp


@dataclass(frozen=True, slots=True)
class ClockBounds:
    """For each clock the largest number in a lower and in an upper bound; −inf if there is none."""

    lower: tuple[float, ...]
    upper: tuple[float, ...]


def joined(several: Sequence[ClockBounds]) -> ClockBounds:
    """The largest of some, at least one, clock by clock."""
    lower, upper = zip(*((one.lower, one.upper) for one in several), strict=True)
    largest = (tuple(map(max, *side)) if len(side) > 1 else side[0] for side in (lower, upper))
    return ClockBounds(*largest)


def location_bounds(
    network: Network,
    automaton: Automaton,
    asked: Mapping[int, Sequence[ClockCompare]] | None = None,
) -> list[ClockBounds]:
    """The bounds of each location of an automaton, from its guards and invariants.

    Args:
        network: of the automaton.
        automaton: whose bounds.
        asked: by location, what a query compares clocks with only while the automaton is there.
    """
    clocks = len(network.clocks)
    lower = [[-inf] * clocks for _ in automaton.locations]
    upper = [[-inf] * clocks for _ in automaton.locations]
    for index, location in enumerate(automaton.locations):
        here = (*location.invariant.clocks, *(asked or {}).get(index, ()))
        _note(here, lower[index], upper[index], network)
    kept: list[tuple[int, int, list[int]]] = []
    for edge in automaton.edges:
        _note(edge.guard.clocks, lower[edge.source], upper[edge.source], network)
        if _is_kept_back(edge, network):  # who is kept back, counts the other way round
            _note(edge.guard.clocks, upper[edge.source], lower[edge.source], network)
        resets = {update.clock for update in edge.updates if isinstance(update, Reset)}
        kept.append((edge.source, edge.target, [c for c in range(clocks) if c not in resets]))
    changed = True
    while changed:
        changed = False
        for source, target, clocks_kept in kept:
            for table in (lower, upper):
                for clock in clocks_kept:
                    if table[target][clock] > table[source][clock]:
                        table[source][clock] = table[target][clock]
                        changed = True
    return [ClockBounds(tuple(low), tuple(high)) for low, high in zip(lower, upper, strict=True)]


def _is_kept_back(edge: Edge, network: Network) -> bool:
    """Whether an edge has no part in a move because its guard on clocks fails."""
    sync = edge.sync
    return sync is not None and not sync.sends and network.channels[sync.slot.first].broadcast


def compared_bounds(network: Network, compares: Iterable[ClockCompare]) -> ClockBounds:
    """The bounds that some comparisons alone need."""
    clocks = len(network.clocks)
    lower, upper = [-inf] * clocks, [-inf] * clocks
    _note(compares, lower, upper, network)
    return ClockBounds(tuple(lower), tuple(upper))


def _note(
    compares: Iterable[ClockCompare], lower: list[float], upper: list[float], network: Network
) -> None:
    for compare in compares:
        table = lower if compare.op in (ClockOp.GE, ClockOp.GT) else upper
        highest = value_range(compare.bound, network)[1]
        table[compare.clock] = max(table[compare.clock], float(max(highest, 0)))


def value_range(expression: Expression, network: Network) -> tuple[int, int]:
    """Numbers between which an expression over the variables lies."""
    match expression:
        case Constant(value):
            return value, value
        case VariableValue(slot):
            first, table = slot.first, network.variables
            if first < 0:
                first, table = first + len(network.locals), network.locals
            variables = table[first : first + slot.size]
            return min(v.low for v in variables), max(v.high for v in variables)
        case Lookup(values, _):
            return min(values), max(values)
        case Invoke(function):
            _, result = function.result
            return result.low, result.high
        case Choice(_, then, otherwise):
            return _hull(value_range(then, network), value_range(otherwise, network))
        case UnaryOperation(UnaryOp.NEGATE, operand):
            low, high = value_range(operand, network)
            return -high, -low
        case UnaryOperation(UnaryOp.INVERT, operand):
            low, high = value_range(operand, network)
            return -high - 1, -low - 1
        case BinaryOperation(op, left, right):
            return _binary_range(op, value_range(left, network), value_range(right, network))
        case InLocation() | UnaryOperation():
            return 0, 1
        case _:
            raise AssertionError(f"{expression} is no number")


def _binary_range(op: BinaryOp, left: tuple[int, int], right: tuple[int, int]) -> tuple[int, int]:
    match op:
        case BinaryOp.ADD:
            return left[0] + right[0], left[1] + right[1]
        case BinaryOp.SUB:
            return left[0] - right[1], left[1] - right[0]
        case BinaryOp.MUL:
            products = [a * b for a in left for b in right]
            return min(products), max(products)
        case BinaryOp.DIV | BinaryOp.MOD | BinaryOp.SHIFT_RIGHT:
            limit = max(map(abs, left))
            return -limit, limit
        case BinaryOp.MINIMUM | BinaryOp.MAXIMUM:
            return _hull(left, right)
        case BinaryOp.SHIFT_LEFT:
            limit = max(map(abs, left)) << min(31, max(0, right[1]))
            return -limit, limit
        case BinaryOp.BIT_AND | BinaryOp.BIT_OR | BinaryOp.BIT_XOR:
            limit = (1 << max(abs(n).bit_length() for n in (*left, *right))) - 1
            return -limit - 1, limit
        case _:
            return 0, 1


def _hull(*ranges: Sequence[int]) -> tuple[int, int]:
    return min(low for low, _ in ranges), max(high for _, high in ranges)
