"""What becomes known of a node of a network, from what became known of its operands.

A position is told of once. Each function looks at the news of the operands, at the ranges around
those in which they are known, and at the time that has passed.
"""

from __future__ import annotations

from rvmon.dataflow.knowledge import Knowledge
from rvmon.dataflow.news_of_past import Step
from rvmon.dataflow.nodes import Junction, Shift, Sweep, Window
from rvmon.dataflow.piecewise import (
    EVER,
    FAR,
    Piece,
    Pieces,
    all_of_window,
    append,
    clip,
    latest,
    shift,
    some_of_window,
    soonest,
)
from rvmon.dataflow.positions import Positions
from rvmon.dataflow.ranges import (
    Range,
    Ranges,
    around,
    gaps,
    last_up_to,
    merged,
    outside,
    overlapping,
    within,
)
from rvmon.dataflow.sweep import until


def news_of_junction(network: Knowledge, place: int, node: Junction) -> None:
    """All of the operands, or one of them."""
    some, all_ = int(node.every), int(not node.every)
    known, news = network.known, network.news
    sources = [found for operand in node.operands if (found := news[operand][some])]
    if sources:
        pieces = sources[0]
        for other in sources[1:]:
            pieces = soonest(pieces, other)
        network.tell(place, some, outside(pieces, known[place][some]))
    changed = [operand for operand in node.operands if news[operand][all_]]
    if len(changed) == 1:
        pieces = news[changed[0]][all_]
        for operand in node.operands:
            if operand != changed[0]:
                pieces = within(pieces, known[operand][all_])
        if pieces:
            network.tell(place, all_, pieces)
    elif changed:
        for on in merged(piece[:2] for operand in changed for piece in news[operand][all_]):
            pieces = clip(EVER, *on)
            for operand in node.operands:
                pieces = latest(pieces, network.side(operand, all_, on))
            network.tell(place, all_, pieces)


def news_of_shift(network: Knowledge, place: int, node: Shift) -> None:
    """The operand further on."""
    for side, pieces in enumerate(network.news[node.operand]):
        if pieces:
            found = network.positions.cells(shift(pieces, node.offset))
            network.tell(place, side, outside(found, network.known[place][side]))


def news_of_window(network: Knowledge, place: int, node: Window, step: Step) -> None:
    """The operand at every position, or some, of a window in the future."""
    some = int(node.every)
    if network.news[node.operand][some] and node.low <= node.high:
        _one_decides(network, place, node, some)
    _all_decide(network, place, node, 1 - some, step)


def _one_decides(network: Knowledge, place: int, node: Window, side: int) -> None:
    """Where one position of a window decides."""
    positions, pending = network.positions, network.pending[place]
    pieces, own = network.news[node.operand][side], network.known[place][side]
    left, right, at, slope = pieces[0]
    if len(pieces) == 1 and not positions.sparse and right < FAR:
        # As a rule it goes on behind what is known.
        start, end = max(left - node.high, pending), right - node.low
        if own and own[-1][0] <= start <= own[-1][1]:
            start = own[-1][1] + 1
        if not own or own[-1][1] < start:
            inner = max(start, left - node.low)
            made: list[Piece] = []
            append(made, start, min(inner - 1, end), at + slope * left, 0)
            append(made, inner, end, at + slope * node.low, slope)
            if made:
                network.tell(place, side, made)
            return
    if positions.sparse:
        pieces = positions.only(pieces, -FAR, FAR)
    found = positions.cells(clip(some_of_window(pieces, node.low, node.high), pending))
    found = outside(found, own)
    if found:
        network.tell(place, side, found)


def _all_decide(network: Knowledge, place: int, node: Window, side: int, step: Step) -> None:
    """Where all positions of a window together decide, once no further one comes to lie in it."""
    low, high, positions = node.low, node.high, network.positions
    due, slope = 2 * (node.over or 0), positions.slope
    first = (step.before - due) // slope + 1
    last = min((step.limit - due) // slope, positions.last)
    pending, news = network.pending[place], network.news[node.operand][side]
    ranges = network.known[node.operand][side]
    spans: Ranges = []
    # Windows that were over before, of which something became known only now.
    for left, right, _, _ in news:
        run = around(ranges, left)
        if run is not None and left - high < first:
            start = max(left - high, run[0] - low, pending)
            spans.append((start, min(right - low, _end_of(run, positions) - high, first - 1)))
    # Windows that are over now.
    start = max(first, pending)
    if start <= last and low <= high:
        runs = overlapping(ranges, start + low, last + low)
        edge = positions.last if step.arrived is None else step.arrived[0] - 1
        if positions.sparse and not (runs and runs[-1][1] >= edge):
            # Behind the last position before, none lay in any of them.
            runs = (*runs, around(ranges, edge) or (edge + 1, edge))
        for run in runs:
            spans.append((max(start, run[0] - low), min(last, _end_of(run, positions) - high)))
    elif start <= last:
        spans.append((start, last))
    for span in merged(spans) if len(spans) > 1 else spans:
        if span[0] <= span[1]:
            found = _over(network, node, side, span)
            if positions.sparse:
                found = outside(positions.cells(found), network.known[place][side])
            network.tell(place, side, found)


def _end_of(run: Range, positions: Positions) -> int:
    """The last integer before the next position that is none of a run."""
    if not positions.sparse:
        return run[1]
    return FAR if run[1] >= positions.last else positions.following(run[1] + 1) - 1


def _over(network: Knowledge, node: Window, side: int, span: Range) -> Pieces:
    """When windows that decide are known to: they are over, and all in them is known."""
    first, last = span
    low, high = node.low, node.high
    due, slope = 2 * (node.over or 0), network.positions.slope
    line = ((first, last, due, slope),)
    for _, _, at, its_slope in network.news[node.operand][side]:
        if at + its_slope * high > (due if its_slope else due + slope * first):
            on = first + low, min(last + high, FAR)
            within_ = network.positions.besides(network.side(node.operand, side, on), *on)
            return latest(clip(all_of_window(within_, low, high), first, last), line)
    return line


def news_of_until(network: Knowledge, place: int, node: Sweep) -> None:
    """`until` without bounds: positions that meet it, and those from which the way leads there."""
    true = int(node.dual)
    changed = [
        (piece[1], piece[0], operand, side)
        for operand in ((node.left, node.right) if node.left != node.right else (node.left,))
        for side in (0, 1)
        for piece in network.news[operand][side]
    ]
    told, bottom = 0, max(network.swept[place], network.pending[place])
    if len(changed) > 1:
        changed.sort(reverse=True)
    for last, first, operand, side in changed:
        spans: Ranges = []
        if operand == node.right:
            spans += _from_right(network, place, node, (first, last), side == true)
        if operand == node.left:
            spans += _from_left(network, place, node, (first, last), side == true)
        for start, end in spans if len(spans) < 2 else sorted(spans, reverse=True):
            on = max(start, bottom), end
            for gap in reversed(gaps(network.known[place][side], on)):
                _tell_until(network, place, node, side, gap)
                told += 1
    if told > 1:
        found_true, found_false = network.news[place]
        network.news[place] = sorted(found_true), sorted(found_false)
    pending = network.pending[place]
    found = network.truth_at(place, bottom) if told and pending < bottom else None
    if found is not None and network.truth_at(place, pending) is None:
        # What lies between only leads on to `bottom`.
        side = int(not found[0])
        before = gaps(network.known[place][side], (pending, bottom - 1))
        network.tell(place, side, [(left, right, found[1], 0) for left, right in before])
        found_true, found_false = network.news[place]
        network.news[place] = sorted(found_true), sorted(found_false)


def _from_right(network: Knowledge, place: int, node: Sweep, on: Range, met: bool) -> Ranges:
    """Where an `until` is known since its right operand is: it is met, or is not, on a stretch."""
    first, last = on
    true, false = int(node.dual), int(not node.dual)
    if met:
        way = around(network.known[node.left][true], first - 1)
        return [(first if way is None else way[0], last)]
    way = around(network.known[node.right][false], first)
    if around(network.known[place][false], last + 1) is None:
        last = last_up_to(network.known[node.left][false], last)
    return [(way[0], last)] if way is not None and last >= first else []


def _from_left(network: Knowledge, place: int, node: Sweep, on: Range, leads_on: bool) -> Ranges:
    """Where an `until` is known since its left operand is: it leads on, or does not."""
    first, last = on
    true, false = int(node.dual), int(not node.dual)
    if leads_on:
        way = around(network.known[node.left][true], first)
        met = last_up_to(network.known[place][true], last + 1)
        return [(way[0], met - 1)] if way is not None and met >= first else []
    unmet = overlapping(network.known[node.right][false], first, last)
    return [(start, min(end, last)) for start, end in unmet]


def _tell_until(network: Knowledge, place: int, node: Sweep, side: int, on: Range) -> None:
    """Tell of a stretch that has become known, and so has the integer behind it, or it is met."""
    edge = network.truth_at(place, on[1] + 1)
    stays, meets = network.side(node.left, side, on), network.side(node.right, side, on)
    if side == node.dual:
        beyond = None if edge is None or edge[0] is node.dual else (True, edge[1])
        found, _ = until((stays, ()), (meets, ()), *on, beyond)
    else:
        beyond = None if edge is None or edge[0] is not node.dual else (False, edge[1])
        _, found = until(((), stays), ((), meets), *on, beyond)
    network.tell(place, side, network.positions.cells(found))
