"""When time alone can make something of a network known, the letter staying.

Behind the last letter all positions are alike: none of those that lie ahead has its value sooner
than the last one that was read. So what comes is that windows open or are over, of which those
matter that something above still waits for, with the values that it waits for. One that is over
decides only if its operand is known to be the same all the way up to now; if that is not so, its
operand has news before. None of this holds of what looks back.
"""

from __future__ import annotations

from bisect import bisect_right

from rvmon.dataflow.network import Network
from rvmon.dataflow.nodes import Junction, Leaf, Shift, Sweep, Window, operands_of
from rvmon.dataflow.piecewise import FAR
from rvmon.dataflow.ranges import Range, Ranges, around
from rvmon.runtime.values import NEVER

Asked = list[list[int]]
"""By node, the first and the last position of which it matters that it is true, then if false."""


def next_news(network: Network, wanted: int) -> int:
    """An instant before which nothing becomes known that is waited for; it may be in vain.

    Args:
        network: as far as time has come.
        wanted: the instant of the first position whose value is waited for.
    """
    positions, nodes = network.positions, network.plan.nodes
    now = min((network.grown - 1) // positions.slope, positions.last)
    asked: Asked = [[FAR, -FAR, FAR, -FAR] for _ in nodes]
    first = wanted // positions.gap
    asked[-1] = [first, now, first, now]
    found = NEVER
    for place, node in reversed(network.plan.inner):
        first_true, last_true, first_false, last_false = asked[place]
        if isinstance(node, Junction):
            for operand in node.operands:
                if not isinstance(nodes[operand], Leaf):
                    _ask(asked[operand], 0, first_true, last_true)
                    _ask(asked[operand], 2, first_false, last_false)
            continue
        first = network.unknown_from(place, min(first_true, first_false))
        last = max(last_true, last_false)
        if first > last:
            continue
        if isinstance(node, Sweep) and node.future:
            _ask_sweep(network, place, node, (first, min(last, now)), now, asked)
            continue
        if isinstance(node, Window) and node.over is not None:
            low, high = node.low, node.high
        elif isinstance(node, Shift) and node.offset >= 0:
            low = high = node.offset
        else:
            for operand in operands_of(node):
                asked[operand] = [-FAR, FAR, -FAR, FAR]
            continue
        own = asked[node.operand]
        for side, start, end in ((0, first_true, last_true), (1, first_false, last_false)):
            if start <= end and first <= end:
                start = max(start, first)
                _ask(own, 2 * side, start + low, end + high)
                if isinstance(node, Window) and side != node.every:
                    found = min(found, _over(network, place, node, side, (start, end), now))
                elif low and not positions.sparse:
                    on = start, end
                    found = min(found, _opening(network, place, node, side, low, on, now))
    return found


def _ask(asked: list[int], index: int, first: int, last: int) -> None:
    if first <= last:
        asked[index] = min(first, asked[index])
        asked[index + 1] = max(last, asked[index + 1])


def _over(network: Network, place: int, node: Window, side: int, on: Range, now: int) -> int:
    """When the next window is over in which the operand is the same up to now."""
    positions, over = network.positions, node.over or 0
    start = max(on[0], (network.grown // 2 - over) // positions.gap + 1)
    if node.low <= node.high:
        run = around(network.known[node.operand][side], now)
        if run is None and not positions.sparse:
            return NEVER
        # Where samples are positions, none may come.
        start = max(start, (now + 1 if run is None else run[0]) - node.low)
    first = network.unknown_from(place, start)
    is_wanted = first <= min(on[1], positions.last)
    return first * positions.gap + over if is_wanted else NEVER


def _opening(
    network: Network,
    place: int,
    node: Window | Shift,
    side: int,
    offset: int,
    on: Range,
    now: int,
) -> int:
    """When the next position comes that a window opens at, or that is so much further on."""
    if around(network.known[node.operand][1 - side], now) is not None:
        return NEVER
    first = network.unknown_from(place, max(on[0], now - offset + 1))
    return (first + offset) * network.positions.gap if first <= on[1] else NEVER


def _ask_sweep(
    network: Network, place: int, node: Sweep, on: Range, now: int, asked: Asked
) -> None:
    """Have the operands of an `until` matter where it is not known."""
    first, last = on
    known, start = network.known, max(first, network.swept[place])
    met, unmet = int(node.dual), int(not node.dual)
    right = asked[node.right]
    _ask(right, 2 * met, start, last)
    if not isinstance(network.plan.nodes[node.left], Leaf):
        _ask(right, 2 * unmet, start, last)
        for side in (met, unmet):
            _ask(asked[node.left], 2 * side, start, last)
        return
    # That it is not met is known of all up to where it does not lead on, or is known not to be met.
    end = min(_next_in(known[node.left][unmet], start), _next_in(known[place][unmet], start))
    if end <= now:
        while (run := _around_either(network, node.right, end)) is not None:
            end = run[0] - 1
        _ask(right, 2 * unmet, max(start, end), last)


def _next_in(ranges: Ranges, integer: int) -> int:
    """The first integer in some ranges from one on; `FAR` if there is none."""
    run = around(ranges, integer)
    if run is not None:
        return integer
    index = bisect_right(ranges, (integer, FAR))
    return ranges[index][0] if index < len(ranges) else FAR


def _around_either(network: Network, place: int, integer: int) -> Range | None:
    true, false = network.known[place]
    return around(true, integer) or around(false, integer)
