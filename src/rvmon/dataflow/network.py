"""The delay network: what is known of each node at each position, and since when.

Each node keeps two functions of the position: the stamp from which on it is known to be true there,
and to be false. They only grow. What becomes known of a node is worked out where something became
known of its operands, and nowhere else; each stretch in one piece, however long it is. Positions
that nothing above can ask for again are dropped.

Source: AUTOMATA 4.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from rvmon.dataflow.evaluate import Range, evaluated
from rvmon.dataflow.nodes import Junction, Leaf, Node, Plan, Shift, Sweep, Window, operands_of
from rvmon.dataflow.pieces import (
    FAR,
    PAST,
    Piece,
    append,
    as_past,
    insert,
    stamp,
    up_to,
    without,
)
from rvmon.dataflow.positions import Positions
from rvmon.dataflow.ranges import drop, end_of, holds, merged, stretch
from rvmon.dataflow.sweep import Carried, Known
from rvmon.formula.core import Core

_FEW = 64
"""So many pieces are never tidied up."""


class Network:
    """One two-valued reading of a word, as far as it is known.

    Args:
        plan: its nodes.
        gap: ticks between two positions; `None` if only samples are positions.

    Attributes:
        plan: its nodes.
        positions: those of the word.
        known: per node, where it is true and where it is false.
        grown: the stamp as of which that is.
        fresh: where the formula became known since somebody looked, in the order of that.
        pending: per node, the first position that is wanted and not known.
        swept: per `until`, up to where its operands only lead on; per `since`, where it is known.
        carried: per `since`, what it is just before that.
    """

    def __init__(self, plan: Plan, gap: int | None) -> None:
        count = len(plan.nodes)
        self.plan = plan
        self.positions = Positions(gap)
        self.known: list[tuple[list[Piece], list[Piece]]] = [([], []) for _ in range(count)]
        self.grown = -FAR
        self.fresh: list[Range] = []
        self._letter: Sequence[bool] = ()
        self._position = -FAR
        self.pending = [-FAR] * count
        self.swept = [-FAR] * count
        self.carried: list[Carried] = [
            (isinstance(node, Sweep) and node.dual, PAST) for node in plan.nodes
        ]
        self._tidy = _FEW

    def copy(self) -> Network:
        """The same, independent from now on."""
        made = Network.__new__(Network)
        made.plan = self.plan
        made.positions = self.positions.copy()
        made.known = [(list(true), list(false)) for true, false in self.known]
        made.grown = self.grown
        made.fresh = list(self.fresh)
        made._letter = self._letter
        made._position = self._position
        made.pending = list(self.pending)
        made.swept = list(self.swept)
        made.carried = list(self.carried)
        made._tidy = self._tidy
        return made

    def visit(self, t: int, letter: Sequence[bool], wanted: int | None) -> None:
        """Come to a position with a letter, which stays until the next visit.

        Args:
            t: its instant.
            letter: the truth of each of the plan's leaves.
            wanted: the instant of the first position whose value is wanted; `None`: this one.
        """
        gap = self.positions.gap
        position = t // gap
        self.grow(2 * t)
        first = self.positions.first == FAR
        behind = self.positions.visit(position)
        self._tidy_up()
        self._want(position if wanted is None else wanted // gap)
        self._letter = letter
        self._position = position
        before, self.grown = self.grown, 2 * t + 1
        if first:
            self._begin()
        slope = self.positions.slope
        line = (2 * position + 1, 0) if self.positions.sparse else (1, slope)
        self._read((behind, position, *line), before)

    def grow(self, limit: int) -> None:
        """Let time come to a stamp, the letter staying at the positions up to there."""
        if limit <= self.grown:
            return
        before, self.grown = self.grown, limit
        if self.positions.first == FAR:
            return
        slope = self.positions.slope
        first, last = self._position + 1, (limit - 1) // slope
        if self.positions.sparse or first > last:
            self._spread({}, before)
        else:
            self._position = last
            self._read((first, last, 1, slope), before)

    def truth(self, t: int) -> Carried:
        """What is known of the formula at the position at `t`, and its stamp."""
        return self._truth_at(len(self.plan.nodes) - 1, t // self.positions.gap)

    def _truth_at(self, place: int, integer: int) -> Carried:
        true, false = self.known[place]
        if (found := stamp(true, integer)) is not None:
            return True, found
        if (found := stamp(false, integer)) is not None:
            return False, found
        return None

    @property
    def next_over(self) -> int | None:
        """The next instant at which the window of an undecided position is over; `None`: never.

        Without a further position, nothing becomes known before in sampled time.
        """
        found = []
        for place, node in enumerate(self.plan.nodes):
            if isinstance(node, Window) and node.over is not None:
                position = self._unknown_from(self.known[place], self.pending[place], skips=True)
                if position <= self.positions.last:
                    found.append(position * self.positions.gap + node.over)
        return min(found, default=None)

    def known_of(self, core: Core) -> Known:
        """What is known of a part of the formula."""
        return self.known[self.plan.places[core]]

    def value_at(self, core: Core, position: int, limit: int) -> bool | None:
        """What is known of a part of the formula at a stamp."""
        found = self._truth_at(self.plan.places[core], position)
        return found[0] if found is not None and found[1] <= limit else None

    def first_unknown(self, core: Core, first: int, limit: int) -> int | None:
        """The first position from `first` on of which a part of the formula is not known.

        Args:
            core: the part.
            first: where to begin.
            limit: the stamp as of which; later positions do not count.
        """
        # What lies before `pending` was known, and may have been dropped.
        first = max(first, self.pending[self.plan.places[core]])
        found = self._unknown_from(self.known_of(core), first, skips=True)
        is_position = found <= self.positions.last and self.positions.slope * found < limit
        return found if is_position else None

    def relative(self, t: int) -> object:
        """All that is known, as seen from `t`."""
        gap = self.positions.gap
        return tuple(
            tuple(
                (left if left <= -FAR else left * gap - t, right * gap - t)
                for left, right, _, _ in as_past(side)
            )
            for known in self.known
            for side in known
        )

    # What is wanted.

    def _want(self, position: int) -> None:
        """Drop what nothing can ask for, from the root down."""
        nodes = self.plan.nodes
        wanted = [FAR] * len(nodes)
        wanted[-1] = position
        for place in range(len(nodes) - 1, -1, -1):
            node, base = nodes[place], wanted[place]
            if isinstance(node, Sweep) and not node.future:
                base = min(base, self._take_over(place))
            for pieces in self.known[place]:
                drop(pieces, base)
            start = max(base, self.pending[place])
            pending = self._unknown_from(
                self.known[place], start, skips=not isinstance(node, Sweep)
            )
            self.pending[place] = pending
            for operand, first in self._asks(place, node, pending):
                wanted[operand] = min(wanted[operand], first)
        self.positions.forget(min(wanted))

    def _unknown_from(self, known: Known, integer: int, *, skips: bool) -> int:
        """The first integer from one on that is in neither; if `skips`, the first position."""
        true, false = known
        while True:
            integer = self.positions.following(integer) if skips else integer
            end = max(end_of(true, integer), end_of(false, integer))
            if end < integer:
                return integer
            integer = end + 1

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
                return [(operand, pending + offset)]
            case Sweep(left=left, right=right):
                if node.future:
                    self._lead_on(place, node, pending)
                return [(left, self.swept[place]), (right, self.swept[place])]
            case _:
                assert_never(node)

    def _lead_on(self, place: int, node: Sweep, pending: int) -> None:
        """Pass the positions whose operands are known and only lead on to the next one."""
        stays, meets = self.known[node.left][node.dual], self.known[node.right][not node.dual]
        start = max(self.swept[place], pending)
        while True:
            start = self.positions.following(start)
            end = min(end_of(stays, start), end_of(meets, start))
            if end < start:
                break
            start = end + 1
        self.swept[place] = start

    def _take_over(self, place: int) -> int:
        """Pass the integers at which a `since` is known; returns the first one behind."""
        start = max(self.swept[place], self.positions.first)
        while (found := self._truth_at(place, start)) is not None:
            self.carried[place] = (found[0], PAST)
            start = end_of(self.known[place][not found[0]], start) + 1
        self.swept[place] = start
        return start

    def _tidy_up(self) -> None:
        """Join pieces whose stamps are of no account any more, when there are many."""
        if sum(len(true) + len(false) for true, false in self.known) > self._tidy:
            self.known = [(as_past(true), as_past(false)) for true, false in self.known]
            count = sum(len(true) + len(false) for true, false in self.known)
            self._tidy = max(_FEW, 2 * count)

    # What becomes known.

    def _begin(self) -> None:
        """Before the first position, nothing has been met."""
        before = (-FAR, self.positions.first - 1, PAST, 0)
        for place, node in enumerate(self.plan.nodes):
            if isinstance(node, Sweep) and not node.future:
                insert(self.known[place][not node.dual], [before])

    def _read(self, piece: Piece, before: int) -> None:
        """Learn the letter of a stretch of integers."""
        changed: dict[int, list[Range]] = {}
        for (place, _), value in zip(self.plan.leaves, self._letter, strict=True):
            append(self.known[place][not value], *piece)
            changed[place] = [piece[:2]]
        self._spread(changed, before, piece[:2] if self.positions.sparse else None)

    def _spread(
        self, changed: dict[int, list[Range]], before: int, arrived: Range | None = None
    ) -> None:
        """Let what became known of the leaves become known of the nodes above.

        Args:
            changed: per leaf, where.
            before: the stamp as of which all is known.
            arrived: of sparse positions, the integers behind the last one up to a new one.
        """
        for place, node in enumerate(self.plan.nodes):
            if isinstance(node, Leaf):
                continue
            candidates = self._candidates(node, changed, before)
            if arrived is not None and isinstance(node, Sweep) and not node.future:
                candidates.append(arrived)
            if candidates:
                ranges = merged(candidates)
                if not isinstance(node, Sweep):
                    fresh = self._extend(place, node, ranges)
                elif node.future:
                    fresh = self._extend_back(place, node, ranges)
                else:
                    fresh = self._extend_on(place, node, ranges)
                if fresh:
                    changed[place] = fresh
        self.fresh += changed.get(len(self.plan.nodes) - 1, ())

    def _candidates(self, node: Node, changed: dict[int, list[Range]], before: int) -> list[Range]:
        """Where something new may be known of a node: its operands changed, or time came."""
        due: int | None
        if isinstance(node, Window):
            low, high = node.low, node.high
            due = 1 if node.over is None else 2 * node.over
        elif isinstance(node, Shift):
            low = high = node.offset
            due = 1 if low < 0 else None
        else:
            return [span for operand in operands_of(node) for span in changed.get(operand, ())]
        found = [(first - high, last - low) for first, last in changed.get(node.operand, ())]
        if due is not None:
            slope = self.positions.slope
            found.append(((before - due) // slope + 1, (self.grown - due) // slope))
        return found

    def _extend(self, place: int, node: Node, ranges: Sequence[Range]) -> list[Range]:
        operands = [self.known[operand] for operand in operands_of(node)]
        fresh: list[Range] = []
        for first, last in ranges:
            first = max(first, self.pending[place])
            if first <= last:
                found = evaluated(node, operands, self.positions, (first, last), None)
                fresh += self._keep(place, found)
        return fresh

    def _extend_back(self, place: int, node: Sweep, ranges: Sequence[Range]) -> list[Range]:
        """Extend an `until` from where its operands changed back to where that matters no more."""
        operands = self.known[node.left], self.known[node.right]
        bottom, fresh = self.swept[place], list[Range]()
        covered = FAR
        for first, last in reversed(ranges):
            first, last = max(first, bottom), min(last, covered - 1)
            while first <= last:
                edge = self._truth_at(place, last + 1)
                found = evaluated(node, operands, self.positions, (first, last), edge)
                new = self._keep(place, found)
                fresh += new
                covered = first
                if not holds(new, first):
                    break
                last = first - 1
                first = max(bottom, *(stretch(operand, last)[0] for operand in operands))
        known, pending = self._truth_at(place, bottom), self.pending[place]
        if known is not None and pending < bottom and self._truth_at(place, pending) is None:
            # What lies between only leads on to `bottom`.
            insert(self.known[place][not known[0]], [(pending, bottom - 1, known[1], 0)])
            fresh.append((pending, bottom - 1))
        return fresh

    def _extend_on(self, place: int, node: Sweep, ranges: Sequence[Range]) -> list[Range]:
        """Extend a `since` from where its operands changed on to where that matters no more."""
        operands = self.known[node.left], self.known[node.right]
        fresh: list[Range] = []
        sparse = self.positions.sparse
        top = self.positions.last if sparse else (self.grown - 1) // self.positions.slope
        covered = self.swept[place] - 1
        for first, last in ranges:
            first, last = max(first, covered + 1), min(last, top)
            while first <= last:
                start = first == self.swept[place]
                edge = self.carried[place] if start else self._truth_at(place, first - 1)
                found = evaluated(node, operands, self.positions, (first, last), edge)
                new = self._keep(place, found)
                fresh += new
                covered = last
                if not holds(new, last):
                    break
                first = last + 1
                if first <= top:
                    last = min(top, *(stretch(operand, first)[1] for operand in operands))
        return fresh

    def _keep(self, place: int, found: Known) -> list[Range]:
        """Add what is new of what was found, as far as it is known by now; returns where."""
        fresh: list[Range] = []
        for pieces, own in zip(found, self.known[place], strict=True):
            new = without(up_to(pieces, self.grown), own)
            insert(own, new)
            fresh += [(left, right) for left, right, _, _ in new]
        return fresh
