"""The largest numbers that clocks are compared with before their next reset, per location.

Source: Behrmann, Bouyer, Fleury, Larsen, Static Guard Analysis in Timed Automata Verification,
TACAS 2003; separate lower and upper bounds as in Behrmann et al., Lower and Upper Bounds in
Zone-Based Abstractions of Timed Automata, 2006.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from rvmon.models.network import Automaton, Network
from rvmon.models.network import expressions as ex

Limits = dict[int, int]
"""The largest number for each clock that is compared with any."""


@dataclass(frozen=True, slots=True)
class ClockBounds:
    """The largest numbers in lower and in upper bounds of clocks."""

    lower: Limits = field(default_factory=dict)
    upper: Limits = field(default_factory=dict)

    def note(self, compares: Iterable[ex.ClockCompare], network: Network) -> None:
        """Include the numbers of some comparisons."""
        for compare in compares:
            table = self.lower if compare.op in (ex.ClockOp.GE, ex.ClockOp.GT) else self.upper
            # The bound may be an expression over variables. The search needs one number for all
            # its values.
            highest = value_range(compare.bound, network)[1]
            table[compare.clock] = max(table.get(compare.clock, 0), highest)


def joined(several: Iterable[ClockBounds]) -> ClockBounds:
    """The largest numbers of several bounds, for each clock."""
    made = ClockBounds()
    for bounds in several:
        for table, own in ((made.lower, bounds.lower), (made.upper, bounds.upper)):
            for clock, number in own.items():
                table[clock] = max(table.get(clock, 0), number)
    return made


def location_bounds(
    network: Network,
    automaton: Automaton,
    of_query: Mapping[int, Sequence[ex.ClockCompare]] | None = None,
) -> list[ClockBounds]:
    """The bounds for each location of an automaton, from its guards and invariants.

    Args:
        network: the whole network.
        automaton: one of its automata.
        of_query: by location, the comparisons of a query that matter only while the automaton is
            there.
    """
    bounds = [ClockBounds() for _ in automaton.locations]
    for index, location in enumerate(automaton.locations):
        bounds[index].note((*location.invariant.clocks, *(of_query or {}).get(index, ())), network)
    resets = []
    for edge in automaton.edges:
        own = bounds[edge.source]
        own.note(edge.guard.clocks, network)
        sync = edge.sync
        if sync is not None and not sync.sends and network.channels[sync.slot.first].broadcast:
            # Where the guard fails, the broadcast goes on without this receiver. So the negated
            # guard matters too, in which lower and upper bounds change places.
            ClockBounds(own.upper, own.lower).note(edge.guard.clocks, network)
        resets.append({update.clock for update in edge.updates if isinstance(update, ex.Reset)})
    # Compute a fixed point: numbers only grow, and each is one of finitely many.
    changed = True
    while changed:
        changed = False
        # Numbers propagate backwards. Edges mostly lead to later locations, so that the reverse
        # order converges sooner.
        for edge, gone in zip(reversed(automaton.edges), reversed(resets), strict=True):
            source, target = bounds[edge.source], bounds[edge.target]
            for here, there in ((source.lower, target.lower), (source.upper, target.upper)):
                for clock, number in list(there.items()):
                    if clock not in gone and number > here.get(clock, -1):
                        here[clock] = number
                        changed = True
    # With priorities a step may be possible because another one is not: negated guards matter.
    if network.priorities is not None:
        for own in bounds:
            both = joined((own, ClockBounds(own.upper, own.lower)))
            own.lower.update(both.lower)
            own.upper.update(both.upper)
    return bounds


def value_range(expression: ex.Expression, network: Network) -> tuple[int, int]:
    """The least and the largest value that an expression over the variables may have."""
    match expression:
        case ex.Constant(value):
            return value, value
        case ex.VariableValue(slot):
            first, table = slot.first, network.variables
            if first < 0:
                first, table = first + len(network.locals), network.locals
            variables = table[first : first + slot.size]
            return min(v.low for v in variables), max(v.high for v in variables)
        case ex.Lookup(values, _):
            return min(values), max(values)
        case ex.Invoke(function):
            _, result = function.result
            return result.low, result.high
        case ex.Choice(_, then, otherwise):
            return _hull(value_range(then, network), value_range(otherwise, network))
        case ex.UnaryOperation(ex.UnaryOp.NEGATE, operand):
            low, high = value_range(operand, network)
            return -high, -low
        case ex.UnaryOperation(ex.UnaryOp.INVERT, operand):
            low, high = value_range(operand, network)
            return -high - 1, -low - 1
        case ex.BinaryOperation(op, left, right):
            return _binary_range(op, value_range(left, network), value_range(right, network))
        case ex.InLocation() | ex.UnaryOperation():
            return 0, 1
        case _:
            raise AssertionError(f"{expression} is no number")


def _binary_range(
    op: ex.BinaryOp, left: tuple[int, int], right: tuple[int, int]
) -> tuple[int, int]:
    match op:
        case ex.BinaryOp.ADD:
            return left[0] + right[0], left[1] + right[1]
        case ex.BinaryOp.SUB:
            return left[0] - right[1], left[1] - right[0]
        case ex.BinaryOp.MUL:
            products = [a * b for a in left for b in right]
            return min(products), max(products)
        case ex.BinaryOp.DIV | ex.BinaryOp.MOD | ex.BinaryOp.SHIFT_RIGHT:
            limit = max(map(abs, left))
            return -limit, limit
        case ex.BinaryOp.MINIMUM | ex.BinaryOp.MAXIMUM:
            return _hull(left, right)
        case ex.BinaryOp.SHIFT_LEFT:
            limit = max(map(abs, left)) << min(31, max(0, right[1]))
            return -limit, limit
        case ex.BinaryOp.BIT_AND | ex.BinaryOp.BIT_OR | ex.BinaryOp.BIT_XOR:
            limit = (1 << max(abs(n).bit_length() for n in (*left, *right))) - 1
            return -limit - 1, limit
        case _:
            return 0, 1


def _hull(*ranges: Sequence[int]) -> tuple[int, int]:
    return min(low for low, _ in ranges), max(high for _, high in ranges)
