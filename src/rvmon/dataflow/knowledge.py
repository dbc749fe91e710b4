"""What a delay network knows of each of its nodes, and what of that is still wanted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self, assert_never

from rvmon.dataflow.nodes import Junction, Leaf, NetworkPlan, Node, Shift, Sweep, Window
from rvmon.dataflow.piecewise import FAR, PAST, Pieces, stamp
from rvmon.dataflow.positions import Positions
from rvmon.dataflow.ranges import Range, Ranges, around, drop, on_stretch
from rvmon.dataflow.ranges import add as add_to
from rvmon.dataflow.sweep import Carried, Known
from rvmon.formula.core import Core

_SELDOM = 16
"""After so many positions it is looked what is still wanted."""


class Knowledge:
    """What is known of the nodes of a network, and when.

    Where positions are sparse, what is known of one is known of all integers back to the position
    before it.

    Args:
        plan: its nodes.
        gap: ticks between two positions; `None` if only samples are positions.

    Attributes:
        plan: its nodes.
        positions: those of the word.
        known: per node, where it is true and where it is false.
        news: what of that became known last, and when, per node of the true ones, then of the
            false ones; all the rest was known before.
        grown: the stamp that time has come to.
        pending: per node, the first position that is wanted and not known.
        swept: per `until`, up to where its operands only lead on; per `since`, where it is known.
        carried: per `since`, what it is just before that.
        watched: by index of a leaf, values that may make something known before it is due.
        noted: the positions, with their letters, that time has not been let come to yet.
        arrived: of sparse positions, one that comes in this step, with the integers before it.
    """

    def __init__(self, plan: NetworkPlan, gap: int | None) -> None:
        count = len(plan.nodes)
        self.plan = plan
        self.positions = Positions(gap)
        self.known: list[tuple[Ranges, Ranges]] = [([], []) for _ in range(count)]
        self.news: list[Pieces] = [()] * (2 * count)
        self.grown = -FAR
        self.pending = [-FAR] * count
        self.swept = [-FAR] * count
        self.carried: list[Carried] = [
            (isinstance(node, Sweep) and node.dual, PAST) for node in plan.nodes
        ]
        self.arrived: Range | None = None
        self._letter: Sequence[bool] = ()
        self.watched: list[tuple[int, bool]] = []
        self.noted: list[tuple[int, Sequence[bool]]] = []
        self._visits = _SELDOM

    def copy(self) -> Self:
        """The same, independent from now on."""
        made = type(self).__new__(type(self))
        made.plan = self.plan
        made.positions = self.positions.copy()
        made.known = [(list(true), list(false)) for true, false in self.known]
        made.news = list(self.news)
        made.grown = self.grown
        made.pending = list(self.pending)
        made.swept = list(self.swept)
        made.carried = list(self.carried)
        made.arrived = None
        made._letter = self._letter
        made.watched = list(self.watched)
        made.noted = list(self.noted)
        made._visits = self._visits
        return made

    def truth(self, t: int) -> Carried:
        """What becomes known of the formula at the position at `t`, and its stamp."""
        return self.truth_at(len(self.plan.nodes) - 1, t // self.positions.gap)

    def truth_at(self, place: int, integer: int) -> Carried:
        """What becomes known of a node at an integer, and its stamp."""
        for side, ranges in enumerate(self.known[place]):
            if around(ranges, integer) is not None:
                at = stamp(self.news[2 * place + side], integer)
                return not side, PAST if at is None else at
        return None

    def pieces(self, place: int, on: Range = (-FAR, FAR)) -> Known:
        """What becomes known of a node on a stretch."""
        return self.side(place, 0, on), self.side(place, 1, on)

    def side(self, place: int, side: int, on: Range) -> Pieces:
        """Where on a stretch a node becomes known to be true (side 0), or false (1)."""
        return on_stretch(self.known[place][side], self.news[2 * place + side], on)

    def known_of(self, core: Core) -> Known:
        """What becomes known of a part of the formula."""
        return self.pieces(self.plan.places[core])

    def news_of(self, core: Core) -> Known:
        """What became known last of a part of the formula."""
        place = self.plan.places[core]
        return self.news[2 * place], self.news[2 * place + 1]

    def value_at(self, core: Core, position: int, limit: int) -> bool | None:
        """What is known of a part of the formula at a stamp."""
        found = self.truth_at(self.plan.places[core], position)
        return found[0] if found is not None and found[1] <= limit else None

    def first_unknown(self, core: Core, first: int, limit: int) -> int | None:
        """The first position from `first` on of which a part of the formula is not known.

        Args:
            core: the part.
            first: where to begin.
            limit: the stamp as of which; later positions do not count.
        """
        # What lies before `pending` was known, and may have been dropped.
        place = self.plan.places[core]
        found = self.unknown_from(place, max(first, self.pending[place]))
        is_position = found <= self.positions.last and self.positions.slope * found < limit
        return found if is_position else None

    def relative(self, t: int) -> object:
        """All that is known, as seen from `t`."""
        gap = self.positions.gap
        return tuple(
            tuple(
                (left if left <= -FAR else left * gap - t, right * gap - t) for left, right in side
            )
            for known in self.known
            for side in known
        )

    def add_news(self, place: int, side: int, pieces: Pieces) -> None:
        """Add to what becomes known of a node; see `add_news`."""
        add_news(self.news, 2 * place + side, self.known[place][side], pieces)

    # What is wanted.

    def want(self, position: int) -> None:
        """Drop what nothing can ask for if a position is the first one that is wanted."""
        nodes = self.plan.nodes
        wanted = [FAR] * len(nodes)
        wanted[-1] = position
        for place in range(len(nodes) - 1, -1, -1):
            node, base = nodes[place], wanted[place]
            if isinstance(node, Sweep):
                base = self.positions.alike_from(base)
                base = base if node.future else min(base, self._take_over(place))
            for ranges in self.known[place]:
                drop(ranges, base)
            start = max(base, self.pending[place])
            pending = self.unknown_from(place, start, skips=not isinstance(node, Sweep))
            self.pending[place] = pending
            for operand, first in self._asks(place, node, pending):
                wanted[operand] = min(wanted[operand], first)
        self.positions.forget(min(wanted))

    def unknown_from(self, place: int, integer: int, *, skips: bool = True) -> int:
        """The first integer from one on that is not known; if `skips`, the first position."""
        true, false = self.known[place]
        positions = self.positions
        skips = skips and (positions.sparse or integer < positions.first)
        while True:
            if skips:
                integer = positions.following(integer)
            run = around(true, integer) or around(false, integer)
            if run is None:
                return integer
            integer = run[1] + 1

    def _end(self, place: int, side: int, integer: int) -> int:
        """The end of what is known around an integer of one side; one less if it is not."""
        found = around(self.known[place][side], integer)
        return integer - 1 if found is None else found[1]

    def _asks(self, place: int, node: Node, pending: int) -> Sequence[tuple[int, int]]:
        """The operands of a node, each with the first integer at which it matters."""
        match node:
            case Leaf():
                return ()
            case Junction(operands=operands):
                return [(operand, pending) for operand in operands]
            case Window(operand=operand, low=low):
                return [(operand, pending + low)]
            case Shift(operand=operand, offset=offset):
                first = pending + offset
                return [(operand, first if offset >= 0 else self.positions.standing_at(first))]
            case Sweep(left=left, right=right):
                if node.future:
                    self._lead_on(place, node, pending)
                return [(left, self.swept[place]), (right, self.swept[place])]
            case _:
                assert_never(node)

    def _lead_on(self, place: int, node: Sweep, pending: int) -> None:
        """Pass the positions whose operands are known and only lead on to the next one."""
        start = max(self.swept[place], pending)
        while True:
            start = self.positions.following(start)
            stays = self._end(node.left, node.dual, start)
            end = min(stays, self._end(node.right, not node.dual, start))
            if end < start:
                break
            start = end + 1
        self.swept[place] = start

    def _take_over(self, place: int) -> int:
        """Pass the integers at which a `since` is known; returns the first one behind."""
        start = max(self.swept[place], self.positions.first)
        while (found := self.truth_at(place, start)) is not None:
            self.carried[place] = (found[0], PAST)
            start = self._end(place, not found[0], start) + 1
        self.swept[place] = start
        return start

    def _tidy_up(self, position: int) -> None:
        """See now and then what is wanted.

        Args:
            position: the first one whose value is wanted.
        """
        self._visits += 1
        if self._visits >= _SELDOM:
            self._visits = 0
            self.want(position)

    def _begin(self) -> None:
        """Before the first position, nothing has been met."""
        for place, node in enumerate(self.plan.nodes):
            if isinstance(node, Sweep) and not node.future:
                add_to(self.known[place][not node.dual], -FAR, self.positions.first - 1)


def add_news(news: list[Pieces], index: int, ranges: Ranges, pieces: Pieces) -> None:
    """Add to what becomes known of a node, ascending; it is not known yet.

    Args:
        news: of the network.
        index: where of that the node has its own.
        ranges: where it is known with this value.
        pieces: where it is from now on.
    """
    if not pieces:
        return
    for left, right, _, _ in pieces:
        if not ranges:
            ranges.append((left, right))
            continue
        start, end = ranges[-1]
        if end == left - 1:
            ranges[-1] = (start, right)
        elif end < left:
            ranges.append((left, right))
        else:
            add_to(ranges, left, right)
    old = news[index]
    if not old:
        news[index] = pieces
    elif old[-1] > pieces[0]:
        news[index] = sorted((*old, *pieces))
    else:
        news[index] = (*old, *pieces)
