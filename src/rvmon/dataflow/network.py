"""The delay network: what is known of each node at each position, and since when.

Each node keeps where it is known to be true, and where to be false, in ranges of positions; of what
became known last, also the stamp as of which it did. Time and letters only ever add to that, and
each node takes from its operands what is new of them: a step costs what it makes known, however
long windows are and however much happens within one. What time alone will make known is worked out
by a copy that goes ahead; the network itself comes along when it is told to. Positions that nothing
above can ask for again are dropped.

Source: AUTOMATA 4.
"""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.dataflow.knowledge import NO_NEWS, Knowledge
from rvmon.dataflow.news import news_of_junction, news_of_shift, news_of_until, news_of_window
from rvmon.dataflow.news_of_past import Step, news_of_past
from rvmon.dataflow.nodes import Junction, Shift, Sweep, Window
from rvmon.dataflow.piecewise import FAR, Piece
from rvmon.dataflow.ranges import Range

FOREVER = 1 << 200
"""Behind all stamps."""


class Network(Knowledge):
    """One two-valued reading of a word, as far as it is known.

    Args:
        plan: its nodes.
        gap: ticks between two positions; `None` if only samples are positions.
    """

    STATE = (
        *("plan", "positions", "known", "news", "grown", "pending", "swept", "carried"),
        *("_letter", "_visits"),
    )

    def visit(self, t: int, letter: Sequence[bool], wanted: int | None) -> None:
        """Come to a position with a letter, which stays until the next visit.

        Args:
            t: its instant.
            letter: the truth of each of the plan's leaves.
            wanted: the instant of the first position whose value is wanted; `None`: this one.
        """
        positions = self.positions
        position = t // positions.gap
        before = self._letter
        first = positions.first == FAR
        # Before there is a position: behind an interrupt, too, each has a letter.
        self._letter = letter
        behind = positions.visit(position)
        self._tidy_up(position if wanted is None else wanted // positions.gap)
        if first:
            self.grown = max(self.grown, 2 * t)
            self._begin()
        self.news = [NO_NEWS] * len(self.plan.nodes)
        if positions.sparse:
            self._read(letter, (behind, position, 1 + 2 * position, 0))
        else:
            start = (self.grown - 1) // positions.slope + 1
            if not first and start < position:
                self._read_on(before, letter, start, position)
            elif start <= position:
                self._read(letter, (position, position, 1, positions.slope))
        self._work_out(2 * t + 1, (behind, position) if positions.sparse else None)

    def grow(self, limit: int) -> None:
        """Let time come to a stamp, the letter staying at the positions up to there."""
        if limit <= self.grown:
            return
        positions = self.positions
        if positions.first == FAR:
            self.grown = limit
            return
        self.news = [NO_NEWS] * len(self.plan.nodes)
        if not positions.sparse:
            slope = positions.slope
            first = max((self.grown - 1) // slope + 1, positions.first)
            last = FAR if limit >= FOREVER else (limit - 1) // slope
            if first <= last:
                self._read(self._letter, (first, last, 1, slope))
        self._work_out(limit, None)

    def _read(self, letter: Sequence[bool], piece: Piece) -> None:
        """Tell the leaves of positions with one letter."""
        for (place, _), value in zip(self.plan.leaves, letter, strict=True):
            self.tell(place, not value, (piece,))

    def _read_on(
        self, before: Sequence[bool], letter: Sequence[bool], start: int, position: int
    ) -> None:
        """Tell the leaves of the positions from `start` on, at the last of which a letter comes."""
        slope = self.positions.slope
        whole = ((start, position, 1, slope),)
        old, new = ((start, position - 1, 1, slope),), ((position, position, 1, slope),)
        for (place, _), was, value in zip(self.plan.leaves, before, letter, strict=True):
            if was is value:
                self.tell(place, not value, whole)
            else:
                self.tell(place, not was, old)
                self.tell(place, not value, new)

    def _work_out(self, limit: int, arrived: Range | None) -> None:
        """Let the other nodes have what becomes known of them up to a stamp, operands first.

        Args:
            limit: the stamp.
            arrived: of sparse positions, one that has come, with the integers before it.
        """
        step = Step(self.grown, limit, arrived)
        for place, node in self.plan.inner:
            if isinstance(node, Window) and node.over is not None:
                news_of_window(self, place, node, step)
            elif isinstance(node, Junction):
                news_of_junction(self, place, node)
            elif isinstance(node, Sweep) and node.future:
                news_of_until(self, place, node)
            elif isinstance(node, Shift) and node.offset >= 0:
                news_of_shift(self, place, node)
            else:
                news_of_past(self, place, node, step)
        self.grown = limit
