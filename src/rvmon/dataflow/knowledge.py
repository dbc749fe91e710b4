"""What a delay network knows of each of its nodes, and what of that is still wanted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self, assert_never

from rvmon.dataflow.nodes import Junction, Leaf, Node, Plan, Shift, Sweep, Window
from rvmon.dataflow.piecewise import FAR, PAST, Piece, as_past, stamp, up_to
from rvmon.dataflow.positions import Positions
from rvmon.dataflow.ranges import drop, end_of, retract, settle
from rvmon.dataflow.sweep import Carried, Known
from rvmon.formula.core import Core

_FEW = 64
"""So many pieces are never tidied up."""

_SELDOM = 4
"""After so many positions it is looked what is still wanted."""


class Knowledge:
    """What is known of the nodes of a network, and when.

    Args:
        plan: its nodes.
        gap: ticks between two positions; `None` if only samples are positions.

    Attributes:
        plan: its nodes.
        positions: those of the word.
        known: per node, where it is true and where it is false, if the letter stays and no further
            position comes where they are sparse.
        grown: the stamp that time has come to; what is known by then stays as it is.
        ahead: the stamp as of which all is worked out, the letter staying; not before `grown`.
        pending: per node, the first position that is wanted and not known.
        swept: per `until`, up to where its operands only lead on; per `since`, where it is known.
        carried: per `since`, what it is just before that.
    """

    def __init__(self, plan: Plan, gap: int | None) -> None:
        count = len(plan.nodes)
        self.plan = plan
        self.positions = Positions(gap)
        self.known: list[tuple[list[Piece], list[Piece]]] = [([], []) for _ in range(count)]
        self.grown = self.ahead = -FAR
        self.pending = [-FAR] * count
        self.swept = [-FAR] * count
        self.carried: list[Carried] = [
            (isinstance(node, Sweep) and node.dual, PAST) for node in plan.nodes
        ]
        self._letter: Sequence[bool] = ()
        self._tidy = _FEW
        self._visits = _SELDOM

    def copy(self) -> Self:
        """The same, independent from now on."""
        made = type(self).__new__(type(self))
        made.plan = self.plan
        made.positions = self.positions.copy()
        made.known = [(list(true), list(false)) for true, false in self.known]
        made.grown, made.ahead = self.grown, self.ahead
        made.pending = list(self.pending)
        made.swept = list(self.swept)
        made.carried = list(self.carried)
        made._letter = self._letter
        made._tidy = self._tidy
        made._visits = self._visits
        return made

    def truth(self, t: int) -> Carried:
        """What becomes known of the formula at the position at `t`, and its stamp."""
        return self._truth_at(len(self.plan.nodes) - 1, t // self.positions.gap)

    @property
    def whole(self) -> Known:
        """What becomes known of the formula."""
        return self.known[-1]

    def _truth_at(self, place: int, integer: int) -> Carried:
        true, false = self.known[place]
        if (found := stamp(true, integer)) is not None:
            return True, found
        if (found := stamp(false, integer)) is not None:
            return False, found
        return None

    def known_of(self, core: Core) -> Known:
        """What becomes known of a part of the formula."""
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
        place = self.plan.places[core]
        found = self._unknown_from(place, max(first, self.pending[place]), limit, skips=True)
        is_position = found <= self.positions.last and self.positions.slope * found < limit
        return found if is_position else None

    def relative(self, t: int) -> object:
        """All that is known, as seen from `t`."""
        gap = self.positions.gap
        return tuple(
            tuple(
                (left if left <= -FAR else left * gap - t, right * gap - t)
                for left, right, _, _ in as_past(up_to(side, self.grown))
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
            skips = not isinstance(node, Sweep)
            pending = self._unknown_from(place, start, self.grown, skips=skips)
            self.pending[place] = pending
            for operand, first in self._asks(place, node, pending):
                wanted[operand] = min(wanted[operand], first)
        self.positions.forget(min(wanted))

    def _unknown_from(self, place: int, integer: int, limit: int, *, skips: bool) -> int:
        """The first integer from one on that is not known; if `skips`, the first position."""
        true, false = self.known[place]
        while True:
            integer = self.positions.following(integer) if skips else integer
            end = max(end_of(true, integer, limit), end_of(false, integer, limit))
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
            end = min(end_of(stays, start, self.grown), end_of(meets, start, self.grown))
            if end < start:
                break
            start = end + 1
        self.swept[place] = start

    def _take_over(self, place: int) -> int:
        """Pass the integers at which a `since` is known; returns the first one behind."""
        start = max(self.swept[place], self.positions.first)
        while (found := self._truth_at(place, start)) is not None and found[1] <= self.grown:
            self.carried[place] = (found[0], PAST)
            start = end_of(self.known[place][not found[0]], start, self.grown) + 1
        self.swept[place] = start
        return start

    def _tidy_up(self, position: int) -> None:
        """See now and then what is wanted, and join pieces when there are many.

        Args:
            position: the first one whose value is wanted.
        """
        self._visits += 1
        if self._visits < _SELDOM:
            return
        self._visits = 0
        self._want(position)
        if sum(len(true) + len(false) for true, false in self.known) > self._tidy:
            for sides in self.known:
                for pieces in sides:
                    settle(pieces, self.grown)
            count = sum(len(true) + len(false) for true, false in self.known)
            self._tidy = max(_FEW, 2 * count)

    def _take_back(self) -> None:
        """Forget what was worked out for times to come."""
        self.ahead = self.grown
        for place, sides in enumerate(self.known):
            for pieces in sides:
                retract(pieces, (self.pending[place], FAR), self.grown)

    def _begin(self) -> None:
        """Before the first position, nothing has been met."""
        before = (-FAR, self.positions.first - 1, PAST, 0)
        for place, node in enumerate(self.plan.nodes):
            if isinstance(node, Sweep) and not node.future:
                self.known[place][not node.dual].insert(0, before)
