"""The delay network: what letters make known of each node at each position, and since when.

It is evaluated in one go over the letters that the core kept, for reasons, forecasts and pictures.

Source: AUTOMATA 4.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from rvmon.logic.formula import Core
from rvmon.logic.network_plan import (
    Junction,
    Leaf,
    NetworkPlan,
    Node,
    Shift,
    Sweep,
    Window,
    operands_of,
)
from rvmon.monitor.network.piecewise import (
    EVER,
    FAR,
    PAST,
    Piece,
    Pieces,
    Positions,
    all_of_window,
    append,
    earliest,
    latest,
    not_before,
    shift,
    some_of_window,
    stamp,
    unchanged_until,
    up_to,
)
from rvmon.monitor.network.sweep import Carried, Known, since, until


def evaluated(node: Node, operands: Sequence[Known], positions: Positions) -> Known:
    """What is known of a node."""
    match node:
        case Junction():
            return _junction(node, operands)
        case Sweep():
            return _sweep(node, operands, positions)
        case Window():
            return _turned(_window(node, _turned(operands[0], node.every), positions), node.every)
        case Shift(offset=offset):
            true, false = operands[0]
            if offset < 0:
                true, false = positions.held_on(true), positions.held_on(false)
            moved = shift(true, offset), shift(false, offset)
            return _not_early(moved, positions) if offset < 0 else moved
        case _:
            raise ValueError("leaves are read")


def _junction(node: Junction, operands: Sequence[Known]) -> Known:
    """All of the operands, or one of them."""
    every = node.every
    all_: Pieces = EVER
    some: Pieces = ()
    for operand in operands:
        all_ = latest(all_, operand[not every])
        some = earliest(some, operand[every])
    return (all_, some) if every else (some, all_)


def _sweep(node: Sweep, operands: Sequence[Known], positions: Positions) -> Known:
    """`until` or `since`."""
    dual = node.dual
    left, right = operands
    stays = positions.besides(left[dual]), positions.only(left[not dual])
    meets = positions.only(right[dual]), positions.besides(right[not dual])
    sweep = until if node.future else since
    return _turned(sweep(stays, meets), dual)


def _window(node: Window, operand: Known, positions: Positions) -> Known:
    """The operand at some position of a window."""
    true = some_of_window(positions.only(operand[0]), node.low, node.high)
    false = all_of_window(positions.besides(operand[1]), node.low, node.high)
    if node.over is None:
        return _not_early((true, false), positions)
    return true, not_before(false, 2 * node.over, positions.slope)


def _not_early(known: Known, positions: Positions) -> Known:
    """What is known of a position is so when that has come."""
    slope = positions.slope
    return not_before(known[0], 1, slope), not_before(known[1], 1, slope)


def _turned(known: Known, dual: bool) -> Known:
    """Negated if `dual`."""
    return (known[1], known[0]) if dual else known


Noted = Sequence[tuple[int, Sequence[bool]]]
"""Instants of positions with their letters: the truth of each leaf, which stays until the next."""


class Network:
    """One two-valued reading of a word, as far as it is known at a stamp.

    Args:
        plan: its nodes.
        gap: ticks between two positions; `None` if only samples are positions.
        noted: the letters, ascending; those behind the stamp do not count.
        first: the instant of the position that is asked for. If it is before all letters, what came
            between only leads on to the first of them.
        limit: the stamp.
        before: a stamp; what was known then is known since ever.

    Attributes:
        plan: its nodes.
        positions: those of the word.
        limit: the stamp.
        start: the first position with a letter.
    """

    def __init__(
        self,
        plan: NetworkPlan,
        gap: int | None,
        noted: Noted,
        first: int,
        limit: int,
        before: int = PAST,
    ) -> None:
        self.plan = plan
        self.limit = limit
        step = gap or 1
        cells = [(t // step, letter) for t, letter in noted if 2 * t < limit]
        self.start = cells[0][0] if cells else FAR
        stamps = [position for position, _ in cells]
        if cells and first // step < self.start:
            stamps.insert(0, first // step)
        self.positions = Positions(gap, stamps)
        self._leaves = (self._samples if gap is None else self._held)(cells)
        self._known = [
            (_aged(up_to(true, limit), before), _aged(up_to(false, limit), before))
            for true, false in self._evaluated(self.positions, FAR)
        ]

    def truth(self, t: int) -> Carried:
        """What is known of the formula at the position at `t`, and its stamp."""
        return _at(self._known[-1], t // self.positions.gap)

    def known_of(self, core: Core) -> Known:
        """What is known of a part of the formula."""
        return self._known[self.plan.places[core]]

    def value_at(self, core: Core, position: int) -> bool | None:
        """What is known of a part of the formula at a position."""
        found = _at(self.known_of(core), position)
        return None if found is None else found[0]

    def first_unknown(self, core: Core, first: int) -> int | None:
        """The first position from `first` on of which a part of the formula is not known."""
        positions = self.positions
        position = positions.following(max(first, self.start))
        while position <= positions.last and positions.slope * position < self.limit:
            if self.value_at(core, position) is None:
                return position
            position = positions.following(unchanged_until(self.known_of(core), position) + 1)
        return None

    @cached_property
    def alone(self) -> Known:
        """What comes to be known of the formula if no further position comes."""
        return self.alone_from(self.limit)

    def alone_from(self, limit: int) -> Known:
        """What comes to be known of the formula if no position comes behind a stamp.

        Source: SEMANTICS 2, Truth after a prefix.
        """
        positions = self.positions.ended((limit - 1) // self.positions.slope)
        return self._evaluated(positions, limit)[-1]

    def _samples(self, cells: Noted) -> list[Known]:
        """The leaves at samples, each with the integers back to the one before it."""
        leaves: list[tuple[list[Piece], list[Piece]]] = [([], []) for _ in self.plan.leaves]
        behind = self.start
        for position, letter in cells:
            for leaf, value in zip(leaves, letter, strict=True):
                append(leaf[not value], behind, position, 1 + 2 * position, 0)
            behind = position + 1
        return [*leaves]

    def _held(self, cells: Noted) -> list[Known]:
        """The leaves at all positions up to the stamp, each with the letter that was last."""
        leaves: list[tuple[list[Piece], list[Piece]]] = [([], []) for _ in self.plan.leaves]
        slope = self.positions.slope
        ends = [position - 1 for position, _ in cells[1:]] + [(self.limit - 1) // slope]
        for (position, letter), end in zip(cells, ends, strict=bool(cells)):
            for leaf, value in zip(leaves, letter, strict=True):
                append(leaf[not value], position, end, 1, slope)
        return [*leaves]

    def _evaluated(self, positions: Positions, limit: int) -> list[Known]:
        """What becomes known of each node, of the leaves what is known at a stamp."""
        nodes = self.plan.nodes
        if self.start == FAR:
            return [((), ())] * len(nodes)
        leaves = iter(self._leaves)
        known: list[Known] = []
        for node in nodes:
            if isinstance(node, Leaf):
                true, false = next(leaves)
                known.append((up_to(true, limit), up_to(false, limit)))
                continue
            operands = [known[operand] for operand in operands_of(node)]
            known.append(evaluated(node, operands, positions))
        if isinstance(nodes[-1], Sweep) and nodes[-1].future and positions.first < self.start:
            true, false = known[-1]
            known[-1] = self._led_on(true), self._led_on(false)
        return known

    def _led_on(self, pieces: Pieces) -> Pieces:
        """With the value at the first letter from the position that is asked for on."""
        at = stamp(pieces, self.start)
        if at is None:
            return pieces
        return earliest(pieces, ((self.positions.first, self.start - 1, at, 0),))


def settled(alone: Known, position: int) -> tuple[int, bool] | None:
    """The last instant before time alone settles the formula at a position, and its value then.

    Args:
        alone: as a network gives it for a stamp at which the value is not known.
        position: as the network counts them.

    Returns:
        `None` if time alone does not settle it.
    """
    found = _at(alone, position)
    return None if found is None else (found[1] // 2 - 1, found[0])


def _at(known: Known, position: int) -> Carried:
    """The value at a position, and its stamp."""
    for value, pieces in zip((True, False), known, strict=True):
        if (found_at := stamp(pieces, position)) is not None:
            return value, found_at
    return None


def _aged(pieces: Pieces, before: int) -> Pieces:
    """With what was known at a stamp known since ever."""
    made: list[Piece] = []
    for left, right, at, slope in pieces:
        end = (before - at) // slope if slope else FAR if at <= before else -FAR
        append(made, left, min(right, end), PAST, 0)
        append(made, max(left, end + 1), right, at, slope)
    return made
