"""What is known of a node on a stretch of integers, given what is known of its operands."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.dataflow.nodes import Junction, Node, Shift, Sweep, Window
from rvmon.dataflow.piecewise import (
    EVER,
    FAR,
    Pieces,
    all_of_window,
    clip,
    latest,
    not_before,
    shift,
    some_of_window,
    soonest,
)
from rvmon.dataflow.positions import Positions
from rvmon.dataflow.ranges import Range
from rvmon.dataflow.sweep import Carried, Known, since, until


def evaluated(
    node: Node, operands: Sequence[Known], positions: Positions, on: Range, edge: Carried
) -> Known:
    """What is known of a node.

    Args:
        node: any but a leaf.
        operands: what is known of them.
        positions: of the word.
        on: the stretch that is asked for.
        edge: of an `until` what is known of it just behind the stretch; of a `since`, just before.
    """
    if isinstance(node, Junction):
        return _junction(node, operands, on)
    if isinstance(node, Sweep):
        return _sweep(node, operands, positions, on, edge)
    first, last = on
    if isinstance(node, Window):
        found = _window(node, _turned(operands[0], node.every), positions, on)
        return _turned(_clipped(found, first, last), node.every)
    if isinstance(node, Shift):
        offset = node.offset
        true, false = operands[0]
        if offset < 0:
            true, false = positions.held_on(true), positions.held_on(false)
        true, false = _clipped((true, false), first + offset, last + offset)
        moved = shift(true, offset), shift(false, offset)
        return _not_early(moved, positions) if offset < 0 else moved
    raise ValueError("leaves are read")


def _junction(node: Junction, operands: Sequence[Known], on: Range) -> Known:
    """All of the operands, or one of them."""
    every = node.every
    all_: Pieces = EVER
    some: Pieces = ()
    for operand in operands:
        all_ = latest(all_, clip(operand[not every], *on))
        some = soonest(some, clip(operand[every], *on))
    return (all_, some) if every else (some, all_)


def _sweep(
    node: Sweep, operands: Sequence[Known], positions: Positions, on: Range, edge: Carried
) -> Known:
    """`until` or `since`."""
    dual = node.dual
    left, right = operands
    stays = positions.besides(left[dual], *on), positions.only(left[not dual], *on)
    meets = positions.only(right[dual], *on), positions.besides(right[not dual], *on)
    around = None if edge is None else (edge[0] is not dual, edge[1])
    sweep = until if node.future else since
    return _turned(sweep(stays, meets, *on, around), dual)


def _window(node: Window, operand: Known, positions: Positions, on: Range) -> Known:
    """The operand at some position of a window."""
    first, last = on[0] + node.low, min(on[1] + node.high, FAR)
    true = some_of_window(positions.only(operand[0], first, last), node.low, node.high)
    false = all_of_window(positions.besides(operand[1], first, last), node.low, node.high)
    if node.over is None:
        return _not_early((true, false), positions)
    return true, not_before(false, 2 * node.over, positions.slope)


def _not_early(known: Known, positions: Positions) -> Known:
    """What is known of a position is so when that has come."""
    slope = positions.slope
    return not_before(known[0], 1, slope), not_before(known[1], 1, slope)


def _clipped(known: Known, first: int, last: int) -> Known:
    return clip(known[0], first, last), clip(known[1], first, last)


def _turned(known: Known, dual: bool) -> Known:
    """Negated if `dual`."""
    return (known[1], known[0]) if dual else known
