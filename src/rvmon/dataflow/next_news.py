"""When time alone can make something of a network known, the letter staying.

Behind the last letter all positions are alike: none of those that lie ahead has its value sooner
than the last one that was read. So what comes is that windows open or are over, of which those
matter that something above still waits for, with the values that it waits for. One that is over
decides only if its operand is known to be the same all the way up to now; if that is not so, its
operand has news before. None of this holds of what looks back.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rvmon.dataflow.knowledge import Knowledge
from rvmon.dataflow.nodes import Junction, Leaf, Shift, Sweep, Window, operands_of
from rvmon.dataflow.piecewise import FAR
from rvmon.dataflow.ranges import around, next_in

Asked = list[int]
"""Of each node the first and the last position at which it matters that it is true, or false."""

NOTHING = (FAR, -FAR, FAR, -FAR)
"""Of a node of which nothing matters."""

Ask = Callable[[Knowledge, Asked, int, int], int]
"""From a network, what matters, the last position that was read and an instant: an earlier one
before which a node has no news by time alone, or that one. It notes what operands matter for."""


def asks_of(network: Knowledge) -> list[Ask]:
    """Those of a network's nodes that look ahead, operators before operands."""
    return [
        ask for place, node in reversed(network.plan.inner) for ask in _asks(network, place, node)
    ]


def _asks(network: Knowledge, place: int, node: Junction | Window | Sweep | Shift) -> Sequence[Ask]:
    if isinstance(node, Junction):
        return (_junction(network, place, node),)
    if isinstance(node, Sweep) and node.future:
        return (_until(network, place, node),)
    if isinstance(node, Window) and node.over is not None:
        over = _over(network, place, node)
        passed_on = _passed_on(network, place, node.operand, node.low, node.high)
        if node.low and not network.positions.sparse:
            return passed_on, over, _opening(network, place, node.operand, node.low, node.every)
        return passed_on, over
    if isinstance(node, Shift) and node.offset >= 0:
        offset = node.offset
        passed_on = _passed_on(network, place, node.operand, offset, offset)
        if offset and not network.positions.sparse:
            openings = (_opening(network, place, node.operand, offset, side) for side in (0, 1))
            return passed_on, *openings
        return (passed_on,)
    return (_behind(node),)


def _note(asked: Asked, index: int, first: int, last: int) -> None:
    if first <= last:
        asked[index] = min(first, asked[index])
        asked[index + 1] = max(last, asked[index + 1])


def _behind(node: Window | Shift | Sweep) -> Ask:
    """What looks back may have need of anything."""

    def ask(_network: Knowledge, asked: Asked, _now: int, found: int) -> int:
        for operand in operands_of(node):
            asked[4 * operand : 4 * operand + 4] = (-FAR, FAR, -FAR, FAR)
        return found

    return ask


def _junction(network: Knowledge, place: int, node: Junction) -> Ask:
    nodes = network.plan.nodes
    own = 4 * place
    operands = [4 * one for one in node.operands if not isinstance(nodes[one], Leaf)]

    def ask(_network: Knowledge, asked: Asked, _now: int, found: int) -> int:
        for operand in operands:
            _note(asked, operand, asked[own], asked[own + 1])
            _note(asked, operand + 2, asked[own + 2], asked[own + 3])
        return found

    return ask


def _passed_on(network: Knowledge, place: int, operand: int, low: int, high: int) -> Ask:
    """Have the operand matter so much further on."""
    own, theirs = 4 * place, 4 * operand
    is_leaf = isinstance(network.plan.nodes[operand], Leaf)

    def ask(network: Knowledge, asked: Asked, _now: int, found: int) -> int:
        first = min(asked[own], asked[own + 2])
        if first < FAR:
            first = network.unknown_from(place, first)
            for index in (own, own + 2):
                if asked[index] < first:
                    asked[index] = first
                if not is_leaf:
                    _note(asked, theirs + index - own, asked[index] + low, asked[index + 1] + high)
        return found

    return ask


def _over(network: Knowledge, place: int, node: Window) -> Ask:
    """When the next window is over in which the operand is the same up to now."""
    positions, gap = network.positions, network.positions.gap
    low, over, empty = node.low, node.over or 0, node.low > node.high
    index = 4 * place + 2 * (not node.every)
    ranges = network.known[node.operand][not node.every]

    def ask(network: Knowledge, asked: Asked, now: int, found: int) -> int:
        start, last = asked[index], asked[index + 1]
        if start > last:
            return found
        start = max(start, (network.grown // 2 - over) // gap + 1)
        if not empty:
            run = around(ranges, now)
            if run is not None:
                start = max(start, run[0] - low)
            elif positions.sparse:
                start = max(start, now + 1 - low)  # none may come
            else:
                return found
        last = min(last, positions.last)
        if start * gap + over >= found or start > last:
            return found
        first = network.unknown_from(place, start)
        return min(found, first * gap + over) if first <= last else found

    return ask


def _opening(network: Knowledge, place: int, operand: int, offset: int, side: int) -> Ask:
    """When the next position comes that a window opens at, or that is so much further on."""
    gap, index = network.positions.gap, 4 * place + 2 * side
    opposite = network.known[operand][1 - side]

    def ask(network: Knowledge, asked: Asked, now: int, found: int) -> int:
        start, last = max(asked[index], now - offset + 1), asked[index + 1]
        if start > last or (start + offset) * gap >= found or around(opposite, now) is not None:
            return found
        first = network.unknown_from(place, start)
        return min(found, (first + offset) * gap) if first <= last else found

    return ask


def _until(network: Knowledge, place: int, node: Sweep) -> Ask:
    """Have the operands of an `until` matter where it is not known."""
    own, left, right = 4 * place, 4 * node.left, 4 * node.right
    met, unmet = int(node.dual), int(not node.dual)
    known, swept = network.known, network.swept
    is_leaf = isinstance(network.plan.nodes[node.left], Leaf)
    is_alone = isinstance(network.plan.nodes[node.right], Leaf)
    left_unmet, own_unmet = known[node.left][unmet], known[place][unmet]
    true, false = known[node.right]

    def ask(network: Knowledge, asked: Asked, now: int, found: int) -> int:
        last = min(max(asked[own + 1], asked[own + 3]), now)
        first = min(asked[own], asked[own + 2])
        if first > last or (is_leaf and is_alone):
            return found
        start = max(network.unknown_from(place, first), swept[place])
        _note(asked, right + 2 * met, start, last)
        if not is_leaf:
            _note(asked, right + 2 * unmet, start, last)
            _note(asked, left, start, last)
            _note(asked, left + 2, start, last)
            return found
        # That it is not met is known of all up to where it does not lead on, or is known not to be.
        end = min(next_in(left_unmet, start), next_in(own_unmet, start))
        if end <= now:
            while (run := around(true, end) or around(false, end)) is not None:
                end = run[0] - 1
            _note(asked, right + 2 * unmet, max(start, end), last)
        return found

    return ask
