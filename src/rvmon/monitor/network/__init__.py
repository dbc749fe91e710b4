"""The delay network: for each node and position, the value and the stamp at which it became known.

Explanations and forecasts evaluate it in one pass over the letters that the core kept.

Source: AUTOMATA 4.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from rvmon.logic import network_plan
from rvmon.logic.formula import Core
from rvmon.monitor.network import piecewise as pw
from rvmon.monitor.network.sweep import Carried, Known, since, until


def evaluated(node: network_plan.Node, operands: Sequence[Known], positions: pw.Positions) -> Known:
    """The known values of a node (not a leaf), from those of its operands."""
    match node:
        case network_plan.Junction():
            return _junction(node, operands)
        case network_plan.Sweep():
            return _sweep(node, operands, positions)
        case network_plan.Window():
            return _swapped(_window(node, _swapped(operands[0], node.every), positions), node.every)
        case network_plan.Shift(offset=offset):
            true, false = operands[0]
            if offset < 0:
                true, false = positions.extended(true), positions.extended(false)
            moved = pw.shift(true, offset), pw.shift(false, offset)
            return _not_early(moved, positions) if offset < 0 else moved
        case _:
            raise ValueError("a leaf has no operands to evaluate")


def _junction(node: network_plan.Junction, operands: Sequence[Known]) -> Known:
    """The conjunction or disjunction of the operands."""
    every = node.every
    all_: pw.Pieces = pw.EVER
    some: pw.Pieces = ()
    for operand in operands:
        all_ = pw.latest(all_, operand[not every])
        some = pw.earliest(some, operand[every])
    return (all_, some) if every else (some, all_)


def _sweep(node: network_plan.Sweep, operands: Sequence[Known], positions: pw.Positions) -> Known:
    """`until` or `since`."""
    dual = node.dual
    left, right = operands
    stays = positions.or_no_position(left[dual]), positions.at_positions(left[not dual])
    meets = positions.at_positions(right[dual]), positions.or_no_position(right[not dual])
    sweep = until if node.future else since
    return _swapped(sweep(stays, meets), dual)


def _window(node: network_plan.Window, operand: Known, positions: pw.Positions) -> Known:
    """Whether the operand is true at some position of a window."""
    true = pw.some_of_window(positions.at_positions(operand[0]), node.low, node.high)
    false = pw.all_of_window(positions.or_no_position(operand[1]), node.low, node.high)
    if node.over is None:
        return _not_early((true, false), positions)
    return true, pw.not_before(false, 2 * node.over, positions.slope)


def _not_early(known: Known, positions: pw.Positions) -> Known:
    """Delay knowledge about a position until that position is reached."""
    slope = positions.slope
    return pw.not_before(known[0], 1, slope), pw.not_before(known[1], 1, slope)


def _swapped(known: Known, dual: bool) -> Known:
    """The known values, with true and false exchanged if `dual`."""
    return (known[1], known[0]) if dual else known


Noted = Sequence[tuple[int, Sequence[bool]]]
"""Instants of positions (ticks) with the truth value of each leaf, in held time up to the next."""


class Network:
    """The network of one run (pessimistic or optimistic), as far as it is known at a stamp.

    Args:
        plan: the nodes.
        gap: ticks between two positions; `None` if only samples are positions.
        noted: the letters, ascending; those after the stamp are ignored.
        first: the instant of the position whose value is needed, ticks. If it is before all
            letters, the positions in between decide nothing: its value is that at the first letter.
        limit: the stamp.
        before: another stamp; everything known by then gets the stamp `PAST`.
    """

    def __init__(
        self,
        plan: network_plan.NetworkPlan,
        gap: int | None,
        noted: Noted,
        first: int,
        limit: int,
        before: int = pw.PAST,
    ) -> None:
        self.plan = plan
        self.limit = limit
        step = gap or 1
        cells = [(t // step, letter) for t, letter in noted if 2 * t < limit]
        self.start = cells[0][0] if cells else pw.FAR  # the first position with a letter
        stamps = [position for position, _ in cells]
        if cells and first // step < self.start:
            # The core drops letters that decide nothing before the first noted one.
            stamps.insert(0, first // step)
        self.positions = pw.Positions(gap, stamps)
        self._leaves = (self._samples if gap is None else self._held)(cells)
        self._known = [
            (
                _known_before(pw.up_to(true, limit), before),
                _known_before(pw.up_to(false, limit), before),
            )
            for true, false in self._evaluated(self.positions, pw.FAR)
        ]

    def truth(self, t: int) -> Carried:
        """The value of the formula at instant `t` (ticks), with its stamp; `None` if unknown."""
        return _at(self._known[-1], t // self.positions.gap)

    def known_of(self, core: Core) -> Known:
        """The known values of a subformula."""
        return self._known[self.plan.places[core]]

    def value_at(self, core: Core, position: int) -> bool | None:
        """The value of a subformula at a position; `None` if unknown."""
        found = _at(self.known_of(core), position)
        return None if found is None else found[0]

    def first_unknown(self, core: Core, first: int) -> int | None:
        """The first position from `first` on at which a subformula is unknown."""
        positions = self.positions
        position = positions.following(max(first, self.start))
        while position <= positions.last and positions.slope * position < self.limit:
            if self.value_at(core, position) is None:
                return position
            position = positions.following(pw.unchanged_until(self.known_of(core), position) + 1)
        return None

    @cached_property
    def alone(self) -> Known:
        """The values of the formula that become known if no further position comes."""
        return self.alone_from(self.limit)

    def alone_from(self, limit: int) -> Known:
        """The values of the formula that become known if no position comes after a stamp.

        Source: SEMANTICS 2, Truth after a prefix.
        """
        positions = self.positions.ended((limit - 1) // self.positions.slope)
        return self._evaluated(positions, limit)[-1]

    def _samples(self, cells: Noted) -> list[Known]:
        """The leaves in sampled time; a value also covers the integers back to the last sample."""
        leaves: list[tuple[list[pw.Piece], list[pw.Piece]]] = [([], []) for _ in self.plan.leaves]
        next_start = self.start
        for position, letter in cells:
            for leaf, value in zip(leaves, letter, strict=True):
                pw.append(leaf[not value], next_start, position, 1 + 2 * position, 0)
            next_start = position + 1
        return [*leaves]

    def _held(self, cells: Noted) -> list[Known]:
        """The leaves in held or clocked time: each letter is held until the next, or the stamp."""
        leaves: list[tuple[list[pw.Piece], list[pw.Piece]]] = [([], []) for _ in self.plan.leaves]
        slope = self.positions.slope
        ends = [position - 1 for position, _ in cells[1:]] + [(self.limit - 1) // slope]
        for (position, letter), end in zip(cells, ends, strict=bool(cells)):
            for leaf, value in zip(leaves, letter, strict=True):
                pw.append(leaf[not value], position, end, 1, slope)
        return [*leaves]

    def _evaluated(self, positions: pw.Positions, limit: int) -> list[Known]:
        """The values that become known of each node, given the leaves as known at stamp `limit`."""
        nodes = self.plan.nodes
        if self.start == pw.FAR:
            return [((), ())] * len(nodes)
        leaves = iter(self._leaves)
        known: list[Known] = []
        for node in nodes:
            if isinstance(node, network_plan.Leaf):
                true, false = next(leaves)
                known.append((pw.up_to(true, limit), pw.up_to(false, limit)))
                continue
            operands = [known[operand] for operand in network_plan.operands_of(node)]
            known.append(evaluated(node, operands, positions))
        if (
            isinstance(nodes[-1], network_plan.Sweep)
            and nodes[-1].future
            and positions.first < self.start
        ):
            true, false = known[-1]
            known[-1] = self._extended_back(true), self._extended_back(false)
        return known

    def _extended_back(self, pieces: pw.Pieces) -> pw.Pieces:
        """Extend the value at the first letter back to the position that is needed."""
        at = pw.stamp(pieces, self.start)
        if at is None:
            return pieces
        return pw.earliest(pieces, ((self.positions.first, self.start - 1, at, 0),))


def settled(alone: Known, position: int) -> tuple[int, bool] | None:
    """The last instant (ticks) before time alone decides the formula at a position, and its value.

    `None` if time alone does not decide it. `alone` comes from `Network.alone`, for a stamp at
    which the value is unknown.
    """
    found = _at(alone, position)
    return None if found is None else (found[1] // 2 - 1, found[0])


def _at(known: Known, position: int) -> Carried:
    """The value at a position with its stamp; `None` if unknown."""
    for value, pieces in zip((True, False), known, strict=True):
        if (found_at := pw.stamp(pieces, position)) is not None:
            return value, found_at
    return None


def _known_before(pieces: pw.Pieces, before: int) -> pw.Pieces:
    """The pieces with the stamp `PAST` wherever something was known by stamp `before`."""
    made: list[pw.Piece] = []
    for left, right, at, slope in pieces:
        end = (before - at) // slope if slope else pw.FAR if at <= before else -pw.FAR
        pw.append(made, left, min(right, end), pw.PAST, 0)
        pw.append(made, max(left, end + 1), right, at, slope)
    return made
