"""The delay network: what is known of each node at each position, and since when.

Each node keeps where it is known to be true, and where to be false, in ranges of positions; of what
became known last, also the stamp as of which it did. Time and letters only ever add to that, and
each node takes from its operands what is new of them: a step costs what it makes known, however
long windows are and however much happens within one. Where the letter stays, a step may go some way
ahead of time, to say beforehand what time alone will make known; if the letter changes, what was
not known by then is taken back. Positions that nothing above can ask for again are dropped.

Source: AUTOMATA 4.
"""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.dataflow.knowledge import NO_NEWS, Knowledge
from rvmon.dataflow.news import news_of_junction, news_of_shift, news_of_until, news_of_window
from rvmon.dataflow.news_of_past import Step, news_of_past
from rvmon.dataflow.nodes import Junction, Shift, Sweep, Window
from rvmon.dataflow.piecewise import FAR, Piece

FOREVER = 1 << 200
"""Behind all stamps."""


class Network(Knowledge):
    """One two-valued reading of a word, as far as it is known.

    Args:
        plan: its nodes.
        gap: ticks between two positions; `None` if only samples are positions.
    """

    STATE = (
        *("plan", "positions", "known", "news", "grown", "ahead", "pending", "swept", "carried"),
        *("_letter", "_visits"),
    )

    def visit(self, t: int, letter: Sequence[bool], wanted: int | None, ahead: int) -> None:
        """Come to a position with a letter, which stays until the next visit.

        Args:
            t: its instant.
            letter: the truth of each of the plan's leaves.
            wanted: the instant of the first position whose value is wanted; `None`: this one.
            ahead: the stamp as of which all is to be worked out at least.
        """
        positions = self.positions
        position = t // positions.gap
        self.grow(2 * t)
        self.take_back()
        first = positions.first == FAR
        # Before there is a position: behind an interrupt, too, each has a letter.
        self._letter = letter
        behind = positions.visit(position)
        self._tidy_up(position if wanted is None else wanted // positions.gap)
        if first:
            self._begin()
        arrived = (behind, position, 2 * position + 1, 0) if positions.sparse else None
        self._step(max(ahead, 2 * t + 1), arrived)
        self.grown = 2 * t + 1

    def grow(self, limit: int) -> None:
        """Let time come to a stamp, the letter staying at the positions up to there."""
        self.foresee(limit)
        self.grown = max(self.grown, limit)

    def foresee(self, limit: int) -> None:
        """Work out what becomes known up to a stamp, if the letter stays."""
        if limit <= self.ahead:
            return
        self.take_back()
        if self.positions.first == FAR:
            self.ahead = limit
        else:
            self._step(limit, None)

    def _step(self, limit: int, arrived: Piece | None) -> None:
        """Let all nodes have what becomes known of them up to a stamp, operands first.

        Args:
            limit: the stamp.
            arrived: of sparse positions, one that has come, with the integers before it.
        """
        before, self.ahead = self.grown, limit
        self.news = [NO_NEWS] * len(self.plan.nodes)
        piece, slope = arrived, self.positions.slope
        if not self.positions.sparse:
            first = max((before - 1) // slope + 1, self.positions.first)
            last = FAR if limit >= FOREVER else (limit - 1) // slope
            piece = (first, last, 1, slope) if first <= last else None
        if piece is not None:
            for (place, _), value in zip(self.plan.leaves, self._letter, strict=True):
                self.tell(place, not value, (piece,))
        step = Step(before, limit, arrived)
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
