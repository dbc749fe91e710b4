"""What is known of a node, given what is known of its operands."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.dataflow.nodes import Junction, Node, Shift, Sweep, Window
from rvmon.dataflow.piecewise import (
    EVER,
    Pieces,
    all_of_window,
    latest,
    not_before,
    shift,
    some_of_window,
    soonest,
)
from rvmon.dataflow.positions import Positions
from rvmon.dataflow.sweep import Known, since, until


def evaluated(node: Node, operands: Sequence[Known], positions: Positions) -> Known:
    """What is known of a node.

    Args:
        node: any but a leaf.
        operands: what is known of them.
        positions: of the word.
    """
    match node:
        case Junction():
            return _junction(node, operands)
        case Sweep():
            return _sweep(node, operands, positions)
        case Window():
            return _turned(_window(node, _turned(operands[0], node.every), positions), node.every)
        case Shift(offset=offset):
            true, false = operands[0]
            if offset < 0:
                true, false = positions.held_on(true), positions.held_on(false)
            moved = shift(true, offset), shift(false, offset)
            return _not_early(moved, positions) if offset < 0 else moved
        case _:
            raise ValueError("leaves are read")


def _junction(node: Junction, operands: Sequence[Known]) -> Known:
    """All of the operands, or one of them."""
    every = node.every
    all_: Pieces = EVER
    some: Pieces = ()
    for operand in operands:
        all_ = latest(all_, operand[not every])
        some = soonest(some, operand[every])
    return (all_, some) if every else (some, all_)


def _sweep(node: Sweep, operands: Sequence[Known], positions: Positions) -> Known:
    """`until` or `since`."""
    dual = node.dual
    left, right = operands
    stays = positions.besides(left[dual]), positions.only(left[not dual])
    meets = positions.only(right[dual]), positions.besides(right[not dual])
    sweep = until if node.future else since
    return _turned(sweep(stays, meets), dual)


def _window(node: Window, operand: Known, positions: Positions) -> Known:
    """The operand at some position of a window."""
    true = some_of_window(positions.only(operand[0]), node.low, node.high)
    false = all_of_window(positions.besides(operand[1]), node.low, node.high)
    if node.over is None:
        return _not_early((true, false), positions)
    return true, not_before(false, 2 * node.over, positions.slope)


def _not_early(known: Known, positions: Positions) -> Known:
    """What is known of a position is so when that has come."""
    slope = positions.slope
    return not_before(known[0], 1, slope), not_before(known[1], 1, slope)


def _turned(known: Known, dual: bool) -> Known:
    """Negated if `dual`."""
    return (known[1], known[0]) if dual else known
