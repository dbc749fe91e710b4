"""What becomes known of a window in the future.

Where one position of it decides, as soon as that does; where all do together, once no further one
comes to lie in it.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from operator import itemgetter

from rvmon.dataflow.knowledge import Knowledge, add_news
from rvmon.dataflow.news import Work
from rvmon.dataflow.nodes import Window
from rvmon.dataflow.piecewise import (
    FAR,
    Piece,
    Pieces,
    all_of_window,
    clip,
    latest,
    rises,
    some_of_window,
)
from rvmon.dataflow.ranges import Ranges, around, merged, on_stretch, outside, overlapping


def window_work(network: Knowledge, place: int, node: Window) -> Work:
    """A window over positions that follow each other."""
    low, high, due = node.low, node.high, 2 * (node.over or 0)
    some, every = int(node.every), int(not node.every)
    news, known, pending = network.news, network.known, network.pending
    positions, slope = network.positions, network.positions.slope
    own_some, own_every = known[place][some], known[place][every]
    given_some, given_every = 2 * node.operand + some, 2 * node.operand + every
    out_some, out_every = 2 * place + some, 2 * place + every
    ranges = known[node.operand][every]
    empty = low > high

    def work(before: int, limit: int) -> None:
        floor = pending[place]
        pieces = news[given_some]
        if pieces and not empty:
            made: list[Piece] = []
            plain = len(pieces) == 1 or rises(pieces)
            for index, (left, right, at, its_slope) in enumerate(pieces):
                # As a rule each goes on behind what is known.
                start, end = left - high, right - low
                if start < floor:
                    start = floor
                last = start - 1
                if own_some:
                    first, last = own_some[-1]
                    if first <= start <= last:
                        start = last + 1
                if last >= start or not plain or right >= FAR:
                    found = clip(some_of_window(pieces[index:], low, high), floor)
                    add_news(news, out_some, own_some, outside(found, own_some))
                    break
                if start > end:
                    continue
                if last == start - 1 and own_some:
                    own_some[-1] = (own_some[-1][0], end)
                else:
                    own_some.append((start, end))
                inner = left - low
                if start >= inner or not its_slope:
                    made.append((start, end, at + its_slope * low, its_slope))
                elif end < inner:
                    made.append((start, end, at + its_slope * left, 0))
                else:
                    made.append((start, inner - 1, at + its_slope * left, 0))
                    made.append((inner, end, at + its_slope * low, its_slope))
            if made:
                news[out_some] = sorted((*made, *news[out_some])) if news[out_some] else made
        pieces = news[given_every]
        start = first = (before - due) // slope + 1
        last = (limit - due) // slope
        if last > positions.last:
            last = positions.last
        spans: Ranges = []
        for left, right, _, _ in pieces:
            # Windows that were over before, of which something became known only now.
            if left - high < first:
                run = around(ranges, left)
                if run is not None:
                    begin = max(left - high, run[0] - low, floor)
                    spans.append((begin, min(right - low, run[1] - high, first - 1)))
        # Windows that are over now.
        if start < floor:
            start = floor
        if start > last:
            pass
        elif empty:
            spans.append((start, last))
        elif ranges and ranges[-1][1] >= start + high:
            for run in overlapping(ranges, start + low, last + low):
                spans.append((max(start, run[0] - low), min(last, run[1] - high)))
        if not spans:
            return
        for span in merged(spans) if len(spans) > 1 else spans:
            first, last = span
            if first > last:
                continue
            line: Pieces = ((first, last, due, slope),)
            for left, right, at, its_slope in pieces:
                if at + its_slope * high > (due if its_slope else due + slope * first):
                    reach = last + (high if its_slope else low)
                    if len(pieces) == 1 and left <= first + high and reach <= right:
                        # All of these windows reach into it.
                        whole: Pieces = ((first, last, at + its_slope * high, its_slope),)
                    else:
                        on = first + low, min(last + high, FAR)
                        whole = positions.besides(on_stretch(ranges, pieces, on), *on)
                        whole = clip(all_of_window(whole, low, high), first, last)
                    line = latest(whole, line)
                    break
            add_news(news, out_every, own_every, line)

    return work


def sampled_window_work(network: Knowledge, place: int, node: Window) -> Work:
    """A window over positions that are far apart; of these, all stamps are level."""
    low, high, due = node.low, node.high, 2 * (node.over or 0)
    some, every = int(node.every), int(not node.every)
    news, known, pending = network.news, network.known, network.pending
    positions, stamps = network.positions, network.positions.stamps
    own_some, own_every = known[place][some], known[place][every]
    given_some, given_every = 2 * node.operand + some, 2 * node.operand + every
    out_some, out_every = 2 * place + some, 2 * place + every
    ranges = known[node.operand][every]

    def note(out: int, own: Ranges, index: int, end: int, at: int) -> None:
        """Tell of the positions from one index to another, with the integers before them."""
        if index < end:
            start = stamps[index - 1] + 1 if index else stamps[0]
            add_news(news, out, own, outside(((start, stamps[end - 1], at, 0),), own))

    def work(before: int, limit: int) -> None:
        floor = pending[place]
        pieces = news[given_some]
        # What is reported first stays: the soonest where one decides, the latest where all do.
        for left, right, at, _ in pieces if len(pieces) < 2 else sorted(pieces, key=_at):
            index, end = bisect_left(stamps, left), bisect_right(stamps, right)
            if low:
                for position in stamps[index:end]:
                    index = bisect_left(stamps, max(position - high, floor))
                    note(out_some, own_some, index, bisect_right(stamps, position - low), at)
            elif index < end:
                index = bisect_left(stamps, max(stamps[index] - high, floor))
                note(out_some, own_some, index, end, at)
        pieces = news[given_every]
        first = (before - due) // 2 + 1
        for left, right, at, _ in (
            pieces if len(pieces) < 2 else sorted(pieces, key=_at, reverse=True)
        ):
            # Windows that were over before, of which something became known only now.
            run = around(ranges, left)
            index = bisect_left(stamps, left)
            if run is None or index == len(stamps) or stamps[index] - high >= first:
                continue
            start = max(stamps[index] - high, run[0] - low, floor)
            last = min(right - low, first - 1)
            if run[1] < positions.last:
                last = min(last, positions.following(run[1] + 1) - 1 - high)
            note(out_every, own_every, bisect_left(stamps, start), bisect_right(stamps, last), at)
        # Windows that are over now.
        last = min((limit - due) // 2, positions.last)
        start = max(first, floor)
        for index in range(bisect_left(stamps, start), bisect_right(stamps, last)):
            position = stamps[index]
            at = due + 2 * position
            start, end = (
                bisect_left(stamps, position + low),
                bisect_right(stamps, position + high),
            )
            if start < end:
                run = around(ranges, stamps[start])
                if run is None or run[1] < stamps[end - 1]:
                    continue
                for left, right, its_at, _ in pieces:
                    if its_at > at and left <= stamps[end - 1] and right >= stamps[start]:
                        at = its_at
            note(out_every, own_every, index, index + 1, at)

    return work


_at = itemgetter(2)
