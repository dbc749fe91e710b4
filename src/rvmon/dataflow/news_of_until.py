"""What becomes known of an `until` without bounds: where it is met, and where the way leads there.

Of its dual all holds of the other values.
"""

from __future__ import annotations

from collections.abc import Callable
from operator import itemgetter

from rvmon.dataflow.knowledge import Knowledge, add_news
from rvmon.dataflow.news import Work
from rvmon.dataflow.nodes import Sweep
from rvmon.dataflow.piecewise import FAR, PAST, Piece, Pieces, append, rises, stamp
from rvmon.dataflow.ranges import (
    Range,
    Ranges,
    around,
    gaps,
    last_up_to,
    on_stretch,
    outside,
    overlapping,
)
from rvmon.dataflow.sweep import Carried, until

Spans = Callable[[Range], Ranges]
"""From a stretch of news to where something is known since."""


def until_work(network: Knowledge, place: int, node: Sweep) -> Work:
    """`left U right`: positions that meet it, and those from which the way leads there."""
    yes, no = int(node.dual), int(not node.dual)
    news, known, positions = network.news, network.known, network.positions
    swept, pending = network.swept, network.pending
    own, left, right = known[place], known[node.left], known[node.right]
    out, in_left, in_right = 2 * place, 2 * node.left, 2 * node.right

    def meets(on: Range) -> Ranges:
        """Where it is known since its right operand is met."""
        way = around(left[yes], on[0] - 1)
        return [(on[0] if way is None else way[0], on[1])]

    def misses(on: Range) -> Ranges:
        """Where it is known since its right operand is not met."""
        first, last = on
        way = around(right[no], first)
        if around(own[no], last + 1) is None:
            last = last_up_to(left[no], last)
        return [(way[0], last)] if way is not None and last >= first else []

    def leads_on(on: Range) -> Ranges:
        """Where it is known since its left operand holds."""
        if not own[yes] or own[yes][-1][1] < on[0]:
            return []
        way = around(left[yes], on[0])
        met = last_up_to(own[yes], on[1] + 1)
        return [(way[0], met - 1)] if way is not None and met >= on[0] else []

    def ends(on: Range) -> Ranges:
        """Where it is known since its left operand does not hold."""
        first, last = on
        unmet = overlapping(right[no], first, last)
        return [(start, min(end, last)) for start, end in unmet]

    def show(side: int, on: Range) -> None:
        """Tell of a stretch that is known by now, as what lies behind it is, or it is met."""
        behind = around(own[side], on[1] + 1)
        beyond: Carried = None
        if behind is not None:
            at = stamp(news[out + side], on[1] + 1)
            beyond = side == yes, PAST if at is None else at
        stays = on_stretch(left[side], news[in_left + side], on)
        met = on_stretch(right[side], news[in_right + side], on)
        if side == no and len(met) == 1 and met[0][:2] == on and met == stays:
            # Wherever the way ends at once, nothing further on is known sooner.
            add_news(news, out + side, own[side], met)
            return
        if side == yes:
            found, _ = until((stays, ()), (met, ()), *on, beyond)
        else:
            _, found = until(((), stays), ((), met), *on, beyond)
        add_news(news, out + side, own[side], positions.cells(found))

    def work(_before: int, _limit: int) -> None:
        bottom = max(swept[place], pending[place])
        met, stays = news[in_right + yes], news[in_left + yes]
        if stays:
            last = max(met[-1][1] if met else -FAR, own[yes][-1][1] if own[yes] else -FAR)
            if last < stays[0][0]:
                stays = ()  # there is nothing to lead to
        shown = False
        if met and not stays and rises(met):
            shown = show_met(met, bottom)
        elif met or stays:
            shown = show_all(yes, met, meets, stays, leads_on, bottom)
        unmet, cut = news[in_right + no], news[in_left + no]
        if unmet and unmet == cut and end_at_once(unmet, bottom):
            add_news(news, out + no, own[no], unmet)
            shown = True
        elif unmet or cut:
            shown = show_all(no, unmet, misses, cut, ends, bottom) or shown
        if shown and pending[place] < bottom:
            lead(bottom)

    def end_at_once(pieces: Pieces, bottom: int) -> bool:
        """Whether, as a rule, pieces lie behind what is known and each one speaks for itself."""
        first = pieces[0][0]
        behind = own[no][-1][1] + 1 if own[no] else -FAR
        if first < bottom or behind > first:
            return False
        for piece in pieces:
            run = around(right[no], piece[0])
            if run is None or (run[0] < piece[0] and piece[0] != behind):
                return False
        return True

    def show_met(pieces: Pieces, bottom: int) -> bool:
        """Report where it is met, each later than what lies further left, and of the way there."""
        found: list[Piece] = []
        for first, last, at, slope in pieces:
            way = around(left[yes], first - 1)
            start = max(bottom, first if way is None else way[0])
            if found and start <= found[-1][1]:
                start = found[-1][1] + 1
            append(found, start, min(first - 1, last), at + slope * first, 0)
            append(found, max(start, first), last, at, slope)
        fresh = outside(found, own[yes])
        add_news(news, out + yes, own[yes], positions.cells(fresh))
        return bool(fresh)

    def show_all(
        side: int,
        right_news: Pieces,
        by_right: Spans,
        left_news: Pieces,
        by_left: Spans,
        bottom: int,
    ) -> bool:
        """Report all that has become known of a side, from the end; whether that is anything."""
        changed = [(piece[1], piece[0], by_right) for piece in right_news]
        if left_news:
            changed += [(piece[1], piece[0], by_left) for piece in left_news]
            changed.sort(key=_last_first, reverse=True)
        else:
            changed.reverse()
        shown = False
        for last, first, spans_of in changed:
            for start, end in reversed(spans_of((first, last))):
                for gap in reversed(gaps(own[side], (max(start, bottom), end))):
                    show(side, gap)
                    shown = True
        return shown

    def lead(bottom: int) -> None:
        """What lies before `bottom` only leads on to it."""
        start = pending[place]
        for side in (0, 1):
            if around(own[side], bottom) is None:
                continue
            if around(own[0], start) is None and around(own[1], start) is None:
                at = stamp(news[out + side], bottom)
                before = gaps(own[side], (start, bottom - 1))
                level = PAST if at is None else at
                add_news(news, out + side, own[side], [(a, b, level, 0) for a, b in before])

    return work


_last_first = itemgetter(0, 1)
