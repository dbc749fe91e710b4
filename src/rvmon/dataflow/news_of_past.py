"""What becomes known of the nodes of a network that look back.

They stand above what is still open ("what was asked for a while ago is met by now"), which is rare:
what there is of the past alone is a proposition. So they are worked out anew wherever something of
their operands became known.
"""

from __future__ import annotations

from rvmon.dataflow.evaluate import evaluated
from rvmon.dataflow.knowledge import Knowledge
from rvmon.dataflow.news import Work
from rvmon.dataflow.nodes import Shift, Sweep, Window, operands_of
from rvmon.dataflow.piecewise import FAR, up_to
from rvmon.dataflow.ranges import Range, Ranges, gaps, merged
from rvmon.dataflow.sweep import Carried


def past_work(network: Knowledge, place: int, node: Window | Shift | Sweep) -> Work:
    """A window in the past, a `since`, or an operand further back."""

    def work(before: int, limit: int) -> None:
        last = network.positions.last
        base = network.swept[place] if isinstance(node, Sweep) else network.pending[place]
        for start, end in _candidates(network, node, before, limit):
            on = max(start, base), min(end, last)
            while on[0] <= on[1]:
                for half in gaps(network.known[place][0], on):
                    for gap in gaps(network.known[place][1], half):
                        _work_out(network, place, node, gap, limit)
                base = on[1] + 1
                if not isinstance(node, Sweep) or network.truth_at(place, on[1]) is None:
                    break
                # What is known of it may lead on.
                on = base, last

    return work


def _candidates(
    network: Knowledge, node: Window | Shift | Sweep, before: int, limit: int
) -> Ranges:
    """Where something may become known of a node: its operands changed, or positions come."""
    low = high = 0
    if isinstance(node, Window):
        low, high = node.low, node.high
    elif isinstance(node, Shift):
        low = high = node.offset
    sources: Ranges = [
        piece[:2]
        for operand in operands_of(node)
        for pieces in network.news[2 * operand : 2 * operand + 2]
        for piece in (network.positions.held_on(pieces) if isinstance(node, Shift) else pieces)
    ]
    arrived = [] if network.arrived is None else [network.arrived]
    found = [
        (first - high if first > -FAR else first, last - low if last < FAR else FAR)
        for first, last in [*sources, *arrived]
    ]
    found += arrived
    if not isinstance(node, Sweep):
        slope = network.positions.slope
        found.append(((before - 1) // slope + 1, (limit - 1) // slope))
    return merged(found)


def _work_out(
    network: Knowledge, place: int, node: Window | Shift | Sweep, on: Range, limit: int
) -> None:
    edge: Carried = None
    if isinstance(node, Sweep):
        start = on[0] == network.swept[place]
        edge = network.carried[place] if start else network.truth_at(place, on[0] - 1)
    operands = [network.pieces(operand) for operand in operands_of(node)]
    found = evaluated(node, operands, network.positions, on, edge)
    for side, pieces in enumerate(found):
        network.add_news(place, side, network.positions.cells(up_to(pieces, limit)))
