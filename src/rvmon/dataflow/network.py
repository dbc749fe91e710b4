"""The delay network: what is known of each node at each position, and since when.

Each node keeps two functions of the position: the stamp from which on it is known to be true there,
and to be false. They reach some way ahead of time and are right as long as the letter stays, so
that they say beforehand what time alone will make known. When the letter changes, what was not
known by then is worked out again, where it rests on what changed and nowhere else; each stretch in
one piece, however long it is. Positions that nothing above can ask for again are dropped.

Source: AUTOMATA 4.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rvmon.dataflow.evaluate import Range, evaluated
from rvmon.dataflow.knowledge import Knowledge
from rvmon.dataflow.nodes import Leaf, Node, Shift, Sweep, Window, operands_of
from rvmon.dataflow.piecewise import FAR, PAST, Piece, Pieces, append, up_to
from rvmon.dataflow.ranges import gaps, holds, insert, merged, retract, some_before
from rvmon.dataflow.sweep import Carried, Known

FOREVER = 1 << 200
"""Behind all stamps."""

_FARTHER = 8
"""What was worked out so many times as far as needed is forgotten."""


class Network(Knowledge):
    """One two-valued reading of a word, as far as it is known.

    Args:
        plan: its nodes.
        gap: ticks between two positions; `None` if only samples are positions.
    """

    STATE = (
        *("plan", "positions", "known", "grown", "ahead", "pending", "swept", "carried"),
        *("_letter", "_tidy", "_visits"),
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
        if self.ahead - self.grown > _FARTHER * (ahead - self.grown):
            self._take_back()
        first = positions.first == FAR
        # Before there is a position: behind an interrupt, too, each has a letter.
        old, self._letter = self._letter, letter
        behind = positions.visit(position)
        self._tidy_up(position if wanted is None else wanted // positions.gap)
        if first:
            self._begin()
        before, self.ahead = self.ahead, max(self.ahead, ahead, 2 * t + 1)
        if positions.sparse:
            arrived = behind, position
            for (place, _), value in zip(self.plan.leaves, letter, strict=True):
                self._go_on(place, value, behind, position)
            self._spread({place: [arrived] for place, _ in self.plan.leaves}, before, arrived)
        else:
            changed = {}
            for index, (place, _) in enumerate(self.plan.leaves):
                start = self._last_by(before) + 1
                if first or old[index] != letter[index]:
                    self._cut(place, not letter[index], position)
                    start = position
                changed[place] = self._stay(place, letter[index], start)
            self._spread(changed, before)
        self.grown = 2 * t + 1

    def grow(self, limit: int) -> None:
        """Let time come to a stamp, the letter staying at the positions up to there."""
        self.foresee(limit)
        self.grown = max(self.grown, limit)

    def foresee(self, limit: int) -> None:
        """Work out what becomes known up to a stamp, if the letter stays."""
        if limit <= self.ahead:
            return
        before, self.ahead = self.ahead, limit
        if self.positions.first == FAR:
            return
        changed = {}
        if not self.positions.sparse:
            start = self._last_by(before) + 1
            for (place, _), value in zip(self.plan.leaves, self._letter, strict=True):
                changed[place] = self._stay(place, value, start)
        self._spread(changed, before)

    def _last_by(self, stamp_: int) -> int:
        """The last integer whose letter is known at a stamp, if positions are consecutive."""
        return FAR if stamp_ >= FOREVER else (stamp_ - 1) // self.positions.slope

    # What becomes known.

    def _go_on(self, place: int, value: bool, behind: int, position: int) -> None:
        """Let a leaf have a value from behind the last position on to a new one."""
        own = self.known[place][not value]
        if own:
            left, right, _, _ = own.pop()
            append(own, left, right, PAST, 0)
        append(own, behind, position, 2 * position + 1, 0)

    def _cut(self, place: int, value: bool, position: int) -> None:
        """Let a leaf not have a value any more from a position on."""
        own = self.known[place][not value]
        if own and own[-1][1] >= position:
            left, _, _, _ = own.pop()
            append(own, left, position - 1, PAST, 0)

    def _stay(self, place: int, value: bool, start: int) -> list[Range]:
        """Let a leaf have a value from an integer on; returns where that was worked out."""
        last = self._last_by(self.ahead)
        append(self.known[place][not value], start, last, 1, self.positions.slope)
        return [(start, last)] if start <= last else []

    def _spread(
        self, changed: dict[int, list[Range]], before: int, arrived: Range | None = None
    ) -> None:
        """Let what becomes known of the leaves become known of the nodes above.

        Args:
            changed: per leaf, where.
            before: the stamp as of which all was worked out.
            arrived: of sparse positions, the integers behind the last one up to a new one.
        """
        for place, node in enumerate(self.plan.nodes):
            if isinstance(node, Leaf):
                continue
            ranges = self._candidates(node, changed, before, arrived)
            if len(ranges) > 1:
                ranges = merged(ranges)
            if not ranges:
                continue
            if not isinstance(node, Sweep):
                fresh = self._extend(place, node, ranges)
            elif node.future:
                fresh = self._extend_back(place, node, ranges)
            else:
                fresh = self._extend_on(place, node, ranges)
            if fresh:
                changed[place] = merged(fresh) if len(fresh) > 1 else fresh

    def _candidates(
        self, node: Node, changed: dict[int, list[Range]], before: int, arrived: Range | None
    ) -> list[Range]:
        """Where something else may become known of a node: its operands changed, or time comes."""
        due: int | None = None
        low = high = 0
        if isinstance(node, Window):
            low, high = node.low, node.high
            due = 1 if node.over is None else 2 * node.over
        elif isinstance(node, Shift):
            low = high = node.offset
            due = 1 if low < 0 else None
        sources = [span for operand in operands_of(node) for span in changed.get(operand, ())]
        if arrived is not None:
            sources.append(arrived)
        found = sources
        if low or high:
            found = [(first - high, last - low if last < FAR else FAR) for first, last in sources]
            if arrived is not None:
                found.append(arrived)
        if due is not None and before < FOREVER:
            slope = self.positions.slope
            first = (before - due) // slope + 1
            last = FAR if self.ahead >= FOREVER else (self.ahead - due) // slope
            if first <= last:
                found.append((first, last))
        return found

    def _extend(self, place: int, node: Node, ranges: Sequence[Range]) -> list[Range]:
        operands = [self.known[operand] for operand in operands_of(node)]
        fresh: list[Range] = []
        for first, last in ranges:
            on = max(first, self.pending[place]), min(last, self.positions.last)
            if on[0] <= on[1]:
                fresh += self._work_out(
                    place,
                    on,
                    lambda gap: evaluated(node, operands, self.positions, gap, None),
                )
        return fresh

    def _extend_back(self, place: int, node: Sweep, ranges: Sequence[Range]) -> list[Range]:
        """Work an `until` out where its operands changed and, if that matters, before."""
        bottom, pending = self.swept[place], self.pending[place]
        operands = self.known[node.left], self.known[node.right]
        fresh: list[Range] = []
        covered = FAR
        for first, last in reversed(ranges):
            on, count = (max(first, bottom), min(last, covered)), 1
            while on[0] <= on[1]:
                fresh += self._work_out(place, on, lambda gap: self._swept(place, node, gap), -1)
                covered = on[0] - 1
                if covered < bottom or not holds(fresh, on[0]):
                    break
                count *= 4
                on = max(bottom, *(some_before(one, covered, count) for one in operands)), covered
        if pending < bottom and holds(fresh, bottom):
            # What lies between only leads on to `bottom`.
            value = self._truth_at(place, bottom)
            fresh += self._work_out(place, (pending, bottom - 1), lambda gap: _led_on(value, gap))
        return fresh

    def _extend_on(self, place: int, node: Sweep, ranges: Sequence[Range]) -> list[Range]:
        """Work a `since` out where its operands changed and, if that matters, behind."""
        bottom, top = self.swept[place], self.positions.last
        fresh: list[Range] = []
        covered = bottom - 1
        for first, last in ranges:
            on = max(first, covered + 1), min(last, top)
            while on[0] <= on[1]:
                fresh += self._work_out(place, on, lambda gap: self._swept(place, node, gap))
                covered = on[1]
                if covered >= top or not holds(fresh, covered):
                    break
                on = covered + 1, top
        return fresh

    def _swept(self, place: int, node: Sweep, on: Range) -> Known:
        """What becomes known of a sweep on a stretch, given what does beside it."""
        edge: Carried
        if node.future:
            edge = None if on[1] >= FAR else self._truth_at(place, on[1] + 1)
        elif on[0] == self.swept[place]:
            edge = self.carried[place]
        else:
            edge = self._truth_at(place, on[0] - 1)
        operands = self.known[node.left], self.known[node.right]
        return evaluated(node, operands, self.positions, on, edge)

    def _work_out(
        self, place: int, on: Range, found: Callable[[Range], Known], order: int = 1
    ) -> list[Range]:
        """Work a node out anew where it is not known by now.

        Args:
            place: of the node.
            on: the stretch.
            found: what becomes known of it on a part of that.
            order: -1 if the last part comes first.

        Returns:
            Where that changed anything.
        """
        known = self.known[place]
        gone = retract(known[0], on, self.grown), retract(known[1], on, self.grown)
        new: tuple[list[Piece], list[Piece]] = [], []
        for gap in gaps(known, on)[::order]:
            for pieces, made, own in zip(found(gap), new, known, strict=True):
                if not pieces:
                    continue
                if self.ahead < FOREVER:
                    pieces = up_to(pieces, self.ahead)
                insert(own, pieces)
                insert(made, pieces)
        if gone[0] == new[0] and gone[1] == new[1]:
            return []
        return [
            (left, right)
            for before, after in zip(gone, new, strict=True)
            if before != after
            for left, right, _, _ in (*before, *after)
        ]


def _led_on(value: Carried, on: Range) -> Known:
    """One value all over a stretch."""
    if value is None:
        return (), ()
    pieces: Pieces = ((*on, value[1], 0),)
    return (pieces, ()) if value[0] else ((), pieces)
