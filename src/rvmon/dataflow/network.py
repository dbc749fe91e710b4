"""The delay network: what is known of each node at each position, and since when.

Each node keeps where it is known to be true, and where to be false, in ranges of positions; of what
became known last, also the stamp as of which it did. Time and letters only ever add to that, and
each node takes from its operands what is new of them: a step costs what it makes known, however
long windows are and however much happens within one. What time alone will make known is worked out
by a copy that goes ahead; the network itself follows when it is asked to. Positions that nothing
above can ask for again are dropped.

Source: AUTOMATA 4.
"""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.dataflow.knowledge import Knowledge
from rvmon.dataflow.news import Work, junction_work, shift_work
from rvmon.dataflow.news_of_past import past_work
from rvmon.dataflow.news_of_until import until_work
from rvmon.dataflow.news_of_window import sampled_window_work, window_work
from rvmon.dataflow.nodes import Junction, Shift, Sweep, Window
from rvmon.dataflow.piecewise import FAR, Piece

Noted = Sequence[tuple[int, Sequence[bool]]]
"""Positions with their letters."""

FOREVER = 1 << 200
"""Behind all stamps."""


class Network(Knowledge):
    """One two-valued reading of a word, as far as it is known.

    Args:
        plan: its nodes.
        gap: ticks between two positions; `None` if only samples are positions.
    """

    _works: Sequence[Work] | None = None
    """What works out the news of the nodes but for leaves, bound to what is known of them."""

    def begin_at(self, start: int, first: int, letter: Sequence[bool]) -> None:
        """Begin in the midst of a word; what is before only leads on to where it does.

        Args:
            start: the position.
            first: the first one whose value is wanted.
            letter: that of the position, the truth of each of the plan's leaves.
        """
        positions, count = self.positions, len(self.plan.nodes)
        positions.first = first
        if positions.sparse:
            positions.last = start - 1
            positions.stamps = [first] if first < start else []
        self.grown = positions.slope * start
        self._letter = letter
        self.pending, self.swept = [start] * count, [start] * count
        self.pending[-1] = first

    def note(self, t: int, letter: Sequence[bool]) -> None:
        """Note a position with a letter, which stays until the next one.

        What it brings is worked out when time is let come to it.

        Args:
            t: its instant.
            letter: the truth of each of the plan's leaves.
        """
        self.noted.append((t // self.positions.gap, letter))

    def grow(self, limit: int, wanted: int | None = None) -> None:
        """Let time come to a stamp, the letters being as noted.

        Args:
            limit: the stamp.
            wanted: the instant of the first position whose value is wanted, if it may have come.
        """
        noted, positions, before = self.noted, self.positions, self._letter
        if limit <= self.grown and not noted:
            return
        if noted:
            self.noted = []
            # Behind an interrupt, too, each position has a letter.
            self._letter = noted[-1][1]
        first = positions.first == FAR
        if first:
            if not noted:
                self.grown = limit
                return
            before = noted[0][1]
            positions.first = noted[0][0]
        if wanted is not None:
            self._tidy_up(wanted // positions.gap)
        if first:
            self.grown = max(self.grown, 2 * positions.first * positions.gap)
            self._begin()
        self.news[:] = [()] * len(self.news)
        if positions.sparse:
            self._read_samples(noted)
        else:
            self._read_held(before, noted, limit)
        since = self.grown
        for work in self._works or self._bound():
            work(since, limit)
        self.grown = limit
        self.arrived = None

    def _read_samples(self, noted: Noted) -> None:
        """Tell the leaves of samples."""
        if not noted:
            return
        cells = []
        for position, letter in noted:
            behind = self.positions.visit(position)
            cells.append(((behind, position, 1 + 2 * position, 0), letter))
        self.arrived = cells[0][0][0], noted[-1][0]
        for index, (place, _) in enumerate(self.plan.leaves):
            true = [cell for cell, letter in cells if letter[index]]
            false = [cell for cell, letter in cells if not letter[index]]
            self.add_news(place, 0, true)
            self.add_news(place, 1, false)

    def _read_held(self, before: Sequence[bool], noted: Noted, limit: int) -> None:
        """Tell the leaves of all positions up to a stamp, each with the letter that was last."""
        slope = self.positions.slope
        start = max((self.grown - 1) // slope + 1, self.positions.first)
        end = FAR if limit >= FOREVER else (limit - 1) // slope
        for index, (place, _) in enumerate(self.plan.leaves):
            first, value = start, before[index]
            sides: tuple[list[Piece], list[Piece]] = [], []
            for position, letter in noted:
                if letter[index] is not value:
                    if first < position:
                        sides[not value].append((first, position - 1, 1, slope))
                        first = position
                    value = letter[index]
            if first <= end:
                sides[not value].append((first, end, 1, slope))
            self.add_news(place, 0, sides[0])
            self.add_news(place, 1, sides[1])

    def _bound(self) -> Sequence[Work]:
        self._works = [_work_of(self, place, node) for place, node in self.plan.inner]
        return self._works


def _work_of(network: Network, place: int, node: Junction | Window | Sweep | Shift) -> Work:
    match node:
        case Junction():
            return junction_work(network, place, node)
        case Window(over=int()):
            made = sampled_window_work if network.positions.sparse else window_work
            return made(network, place, node)
        case Sweep(future=True):
            return until_work(network, place, node)
        case Shift() if node.offset >= 0:
            return shift_work(network, place, node)
        case _:
            return past_work(network, place, node)
