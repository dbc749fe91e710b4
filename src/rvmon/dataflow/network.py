"""The delay network: what is known of each node at each position, and since when.

Each node keeps two functions of the position: from which stamp on it is known to be true there, and
to be false. As long as the letter stays, all that will become known is in them already, with its
stamp, as if the letter went on for ever. A new letter drops what lies ahead of it, and only that is
worked out anew. Positions that nothing above can ask for again are dropped.

Source: AUTOMATA 4.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from operator import itemgetter
from typing import assert_never

from rvmon.dataflow.nodes import Junction, Leaf, Node, Plan, Shift, Sweep, Window
from rvmon.dataflow.pieces import (
    FAR,
    PAST,
    Pieces,
    all_of_window,
    clip,
    known_by,
    latest,
    not_before,
    shift,
    some_of_window,
    soonest,
    stamp,
)
from rvmon.dataflow.positions import Positions
from rvmon.dataflow.sweep import Carried, Known, since, until
from rvmon.formula.core import Core

NOTHING: Known = ((), ())


class Network:
    """One two-valued reading of a word, as far as it is known.

    Args:
        plan: its nodes.
        gap: ticks between two positions; `None` if only samples are positions.

    Attributes:
        plan: its nodes.
        positions: those of the word.
        known: per node, where it is true and where it is false.
    """

    def __init__(self, plan: Plan, gap: int | None) -> None:
        count = len(plan.nodes)
        self.plan = plan
        self.positions = Positions(gap)
        self.known: list[Known] = [NOTHING] * count
        self._pending = [-FAR] * count
        """Per node, the first position that is wanted and not known."""
        self._swept = [-FAR] * count
        """Per `until`, up to where its operands only lead on; per `since`, what is known of it."""
        self._carried: list[Carried] = [
            (isinstance(node, Sweep) and node.dual, PAST) for node in plan.nodes
        ]

    def copy(self) -> Network:
        """The same, independent from now on."""
        made = Network(self.plan, None)
        made.positions = self.positions.copy()
        made.known = list(self.known)
        made._pending = list(self._pending)
        made._swept = list(self._swept)
        made._carried = list(self._carried)
        return made

    def visit(self, t: int, letter: Sequence[bool], wanted: int | None) -> None:
        """Come to a position with a letter, which from now on is taken to stay.

        Args:
            t: its instant.
            letter: the truth of each of the plan's leaves.
            wanted: the instant of the first position whose value is wanted; `None`: this one.
        """
        gap = self.positions.gap
        position = t // gap
        self.settle(2 * t)
        behind = self.positions.visit(position)
        self._want(position if wanted is None else wanted // gap)
        self._read(letter, behind, position)
        for place, node in enumerate(self.plan.nodes):
            if not isinstance(node, Leaf):
                operands = [self.known[operand] for operand in operands_of(node)]
                true, false = self._value(place, node, operands)
                # What a `since` is, is asked for by itself as well, at the next position.
                is_since = isinstance(node, Sweep) and not node.future
                start = -FAR if is_since else self._pending[place]
                old_true, old_false = self.known[place]
                self.known[place] = (
                    soonest(old_true, clip(true, start)),
                    soonest(old_false, clip(false, start)),
                )

    def settle(self, limit: int) -> None:
        """Keep what is known at a stamp, and drop what would become known later."""
        self.known = [(known_by(true, limit), known_by(false, limit)) for true, false in self.known]
        for place, node in enumerate(self.plan.nodes):
            if isinstance(node, Sweep) and not node.future:
                self._take_over(place)

    def truth(self, t: int) -> Carried:
        """What is known of the formula at the position at `t`, and its stamp."""
        position = t // self.positions.gap
        true, false = self.known[-1]
        if (found := stamp(true, position)) is not None:
            return True, found
        if (found := stamp(false, position)) is not None:
            return False, found
        return None

    def known_of(self, core: Core) -> Known:
        """What is known of a part of the formula."""
        return self.known[self.plan.places[core]]

    def value_at(self, core: Core, position: int, limit: int) -> bool | None:
        """What is known of a part of the formula at a stamp."""
        for pieces, value in zip(self.known_of(core), (True, False), strict=True):
            at = stamp(pieces, position)
            if at is not None and at <= limit:
                return value
        return None

    def first_unknown(self, core: Core, first: int, limit: int) -> int | None:
        """The first position from `first` on of which a part of the formula is not known.

        Args:
            core: the part.
            first: where to begin.
            limit: the stamp as of which; later positions do not count.
        """
        true, false = (known_by(pieces, limit) for pieces in self.known_of(core))
        while True:
            first = self.positions.following(first)
            end = max(_end_of_run(true, first), _end_of_run(false, first))
            if end < first:
                return first if self.positions.slope * first < limit else None
            first = end + 1

    def held_at_end(self, end: int, reached: int) -> Pieces:
        """The positions at which the rule for the end of a trace makes the formula true.

        To be asked last: what lies behind the end is dropped.

        Args:
            end: the last instant of the trace.
            reached: the instant that time has come to.
        """
        limit = max(2 * reached, 2 * end + 1)
        self.settle(limit)
        self.positions.end(end // self.positions.gap)
        held: list[Pieces] = []
        for place, node in enumerate(self.plan.nodes):
            true, _ = self.known[place]
            if not isinstance(node, Leaf):
                operands: list[Known] = [(held[operand], ()) for operand in operands_of(node)]
                found = self._value(place, node, operands, at_end=True)[0]
                if isinstance(node, Shift):
                    found = clip(found, -FAR, (end - node.opens) // self.positions.gap)
                true = soonest(true, clip(known_by(found, limit), self._pending[place]))
            held.append(true)
        return held[-1]

    def cuts(self, t: int) -> Iterator[int]:
        """The instants after `t` at which something becomes known otherwise than just before."""
        for pieces in (side for known in self.known for side in known):
            for left, right, at, slope in pieces:
                for end in (left, right):
                    if -FAR < end < FAR and (at + slope * end) // 2 > t:
                        yield (at + slope * end) // 2

    def relative(self, t: int) -> object:
        """All that is known, as seen from `t`."""
        gap = self.positions.gap
        return tuple(
            tuple(
                (
                    left if left <= -FAR else left * gap - t,
                    right if right >= FAR else right * gap - t,
                    at if at == PAST else at - 2 * t + slope * (t // gap),
                    slope,
                )
                for left, right, at, slope in side
            )
            for known in self.known
            for side in known
        )

    # What is wanted.

    def _want(self, position: int) -> None:
        """Drop what nothing can ask for, from the root down."""
        wanted = [FAR] * len(self.plan.nodes)
        wanted[-1] = position
        for place in range(len(wanted) - 1, -1, -1):
            base = wanted[place]
            true, false = self.known[place]
            self.known[place] = true, false = clip(true, base), clip(false, base)
            pending = self._pending[place] = self._unknown_from(place, base)
            for operand, start in self._asks(place, pending):
                wanted[operand] = min(wanted[operand], start)
        self.positions.forget(min(wanted))

    def _unknown_from(self, place: int, integer: int) -> int:
        """The first position from `integer` on of which a node is not known.

        Of an `until` or `since`, what it is at an integer between positions is asked for as well.
        """
        true, false = self.known[place]
        skips = not isinstance(self.plan.nodes[place], Sweep)
        while True:
            integer = self.positions.following(integer) if skips else integer
            end = max(_end_of_run(true, integer), _end_of_run(false, integer))
            if end < integer:
                return integer
            integer = end + 1

    def _asks(self, place: int, pending: int) -> Sequence[tuple[int, int]]:
        """The operands of a node, each with the first position at which it matters."""
        node = self.plan.nodes[place]
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
                return [(left, self._swept[place]), (right, self._swept[place])]
            case _:
                assert_never(node)

    def _lead_on(self, place: int, node: Sweep, pending: int) -> None:
        """Pass the positions whose operands are known and only lead on to the next one."""
        stays, meets = self.known[node.left][node.dual], self.known[node.right][not node.dual]
        start = max(self._swept[place], pending)
        while True:
            start = self.positions.following(start)
            end = min(_end_of_run(stays, start), _end_of_run(meets, start))
            if end < start:
                break
            start = end + 1
        self._swept[place] = start

    def _take_over(self, place: int) -> None:
        """Pass the integers at which a `since` is known."""
        if self.positions.first == FAR:
            return
        start = max(self._swept[place], self.positions.first)
        for_sure = self.known[place]
        while True:
            ends = [_end_of_run(pieces, start) for pieces in for_sure]
            if max(ends) < start:
                break
            self._carried[place] = (ends[0] >= start, PAST)
            start = max(ends) + 1
        self._swept[place] = start

    # What becomes known.

    def _read(self, letter: Sequence[bool], behind: int, position: int) -> None:
        last, at, slope = FAR, 1, self.positions.slope
        if self.positions.sparse:
            last, at, slope = position, 2 * position + 1, 0
        new = ((behind, last, at, slope),)
        for (place, _), value in zip(self.plan.leaves, letter, strict=True):
            true, false = self.known[place]
            self.known[place] = (
                (soonest(true, new), false) if value else (true, soonest(false, new))
            )

    def _value(
        self, place: int, node: Node, operands: Sequence[Known], *, at_end: bool = False
    ) -> Known:
        """What is known of a node, given that of its operands."""
        match node:
            case Leaf():
                raise ValueError("leaves are read")
            case Junction(every=every):
                result = operands[0]
                for operand in operands[1:]:
                    if every:
                        result = latest(result[0], operand[0]), soonest(result[1], operand[1])
                    else:
                        result = soonest(result[0], operand[0]), latest(result[1], operand[1])
                return result
            case Window(every=every):
                return _turned(self._window(node, _turned(operands[0], every)), every)
            case Shift(offset=offset):
                (true, false) = operands[0]
                moved = shift(true, offset), shift(false, offset)
                return self._not_early(moved) if offset < 0 else moved
            case Sweep(dual=dual):
                left, right = (_turned(operand, dual) for operand in operands)
                only, besides = self.positions.only, self.positions.besides
                stays = besides(left[0]), only(left[1])
                meets = only(right[0]), besides(right[1])
                if node.future:
                    beyond = (False, PAST) if at_end and node.kept else None
                    found = self._until(place, stays, meets, beyond)
                else:
                    found = self._since(place, stays, meets, dual)
                return _turned(found, dual)
            case _:
                assert_never(node)

    def _window(self, node: Window, operand: Known) -> Known:
        """The operand at some position of a window."""
        true = some_of_window(self.positions.only(operand[0]), node.low, node.high)
        false = all_of_window(self.positions.besides(operand[1]), node.low, node.high)
        if node.over is None:
            return self._not_early((true, false))
        return true, not_before(false, 2 * node.over, self.positions.slope)

    def _not_early(self, known: Known) -> Known:
        """What is known of a position is so when that has come."""
        slope = self.positions.slope
        return not_before(known[0], 1, slope), not_before(known[1], 1, slope)

    def _until(self, place: int, stays: Known, meets: Known, beyond: Carried) -> Known:
        start, pending = self._swept[place], self._pending[place]
        true, false = until(stays, meets, start, beyond)
        if pending < start:
            # What lies between only leads on to `start`.
            at_start = stamp(true, start), stamp(false, start)
            ways = [() if at is None else ((pending, start - 1, at, 0),) for at in at_start]
            true, false = soonest(true, ways[0]), soonest(false, ways[1])
        return true, false

    def _since(self, place: int, stays: Known, meets: Known, dual: bool) -> Known:
        value, at = self._carried[place] or (dual, PAST)
        start = self._swept[place]
        true, false = since(stays, meets, start, (value is not dual, at))
        if self.positions.sparse:
            true, false = (
                clip(true, start, self.positions.last),
                clip(false, start, self.positions.last),
            )
        before = ((-FAR, self.positions.first - 1, PAST, 0),)
        return true, soonest(false, before)


def operands_of(node: Node) -> tuple[int, ...]:
    """The places of a node's operands."""
    match node:
        case Leaf():
            return ()
        case Junction(operands=operands):
            return operands
        case Window(operand=operand) | Shift(operand=operand):
            return (operand,)
        case Sweep(left=left, right=right):
            return left, right
        case _:
            assert_never(node)


def _turned(known: Known, dual: bool) -> Known:
    """Negated if `dual`."""
    return (known[1], known[0]) if dual else known


def _end_of_run(pieces: Pieces, integer: int) -> int:
    """The end of the stretch that holds an integer, of pieces that are all `PAST`."""
    index = bisect_right(pieces, integer, key=itemgetter(0)) - 1
    return pieces[index][1] if index >= 0 and pieces[index][1] >= integer else integer - 1
