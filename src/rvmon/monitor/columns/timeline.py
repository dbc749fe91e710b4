"""State formulas along a trace that is taken in pieces, as stretches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial, reduce
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from rvmon.formula.state import Elapsed, State, StateOp
from rvmon.monitor.columns.axis import Axis, RowAxis, TickAxis
from rvmon.monitor.columns.doubt import Doubt
from rvmon.monitor.columns.leaves import Columns, Truth, combined, known_truth, negated
from rvmon.monitor.columns.past import Previous, Since
from rvmon.monitor.columns.reading import Flat, Reading, steady
from rvmon.monitor.columns.stretches import between, complement, in_at_least, nowhere
from rvmon.plan.plan import Plan

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.monitor.columns.stretches import Toggles


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """What is known of a piece of a trace.

    Attributes:
        axis: its positions.
        places: int64[n], of its rows.
        flats: by node, what looks at one position.
        before: by node, the truth of these before the first row.
        truths: by node, the stretches of what was asked for.
    """

    axis: Axis
    places: NDArray[np.int64]
    flats: dict[int, Flat]
    before: dict[int, Truth]
    truths: dict[int, Truth]

    def seen(self, leaves: Sequence[int], places: NDArray[np.int64]) -> NDArray[np.int64]:
        """What leaves are at each place, as `rvmon.runtime.bulk.packed` puts it.

        Args:
            leaves: nodes that look at one position.
            places: of the piece, or the one before it.
        """
        code = np.zeros(len(places), np.int64)
        if not len(places):
            return code
        row = np.searchsorted(self.places, places, "right") - 1
        early = row < 0
        exact = self.places[row] == places if len(self.places) else early
        for leaf in leaves:
            flat = self.flats[leaf]
            value = _at_rows(flat.at, row)
            if flat.between is not flat.at:
                value = np.where(exact, value, _at_rows(flat.between, row))
            if early.any():
                before = self.before[leaf]
                value = np.where(early, before.must + before.may, value)
            code = 3 * code + value
        return code


class Timeline:
    """Evaluates the state formulas of a plan, piece by piece.

    Args:
        plan: has the formulas.
        names: of the columns: signals that every row updates, events.
        asked: the nodes of which stretches are wanted.
    """

    def __init__(self, plan: Plan, names: frozenset[str], asked: frozenset[int]) -> None:
        self._plan = plan
        self._reading = Reading(plan.graph.nodes, names)
        nodes = plan.graph.nodes
        self._flat = [False] * len(nodes)
        for place, state in enumerate(nodes):
            operands = plan.graph.operands[place]
            combines = state.op in (StateOp.NOT, StateOp.AND, StateOp.OR, StateOp.SURE)
            is_leaf = state.leaf is not None and not isinstance(state.leaf, Elapsed)
            self._flat[place] = is_leaf or (combines and all(self._flat[o] for o in operands))
        below = {
            operand
            for place, operands in enumerate(plan.graph.operands)
            if not self._flat[place]
            for operand in operands
        }
        self._asked = sorted(place for place in asked | below if self._flat[place])
        self._memory: dict[int, _Memory[Previous] | _Memory[Since] | Doubt] = {}
        for place, state in enumerate(nodes):
            if state.op is StateOp.PREVIOUS:
                self._memory[place] = _Memory(Previous())
            elif state.op is StateOp.SINCE:
                self._memory[place] = _Memory(Since(state.low, state.high))
            elif state.op is StateOp.DOUBT:
                self._memory[place] = Doubt(state.pulse)
        self._origin: int | None = None
        self._last = 0
        self._row = 0
        self._now: dict[int, Truth] = {}
        """Of flat formulas, the truth behind the last row, or at it if nothing is behind."""
        self._here: dict[int, Truth] = {}
        """The same at the last place."""

    def take(self, times: NDArray[np.int64], columns: Columns) -> Piece:
        """Go on with rows; they are later than all before.

        Args:
            times: int64[n] ticks, n > 0.
            columns: by name, of the same length.
        """
        if self._origin is None:
            self._origin = self._last = int(times[0])
            self._last -= 1
        axis: Axis
        if self._plan.gap is None:
            axis = RowAxis(self._row, times, self._last)
            places = np.arange(self._row, self._row + len(times))
        else:
            axis, places = TickAxis(self._last + 1, int(times[-1]) + 1), times
        flats = self._flats(columns, len(times))
        truths = {place: self._laid_out(place, flats[place], axis, places) for place in self._asked}
        self._row += len(times)
        self._last = int(times[-1])
        before = self._now
        self._here = {place: _at_last(flat.at) for place, flat in flats.items()}
        self._now = self._here
        if self._plan.gap is not None:
            self._now = {place: _at_last(flat.between) for place, flat in flats.items()}
        return self._piece(axis, places, flats, before, truths)

    def last_piece(self, end: int) -> Piece:
        """Go on to the end of the trace, behind the last row."""
        axis: Axis
        none = np.empty(0, np.int64)
        if self._plan.gap is None:
            axis = RowAxis(self._row, none, self._last)
        else:
            axis = TickAxis(self._last + 1, end + 1)
        if axis.start < axis.stop:
            self._here = self._now
        flats = {}
        truths = {}
        everywhere = between(axis.start, axis.stop)
        for place, now in self._now.items():
            flats[place] = steady(known_truth(np.zeros(1, bool)))
            whole = [everywhere if held else nowhere() for held in (now.must, now.may)]
            truths[place] = known_truth(whole[0]) if now.known else Truth(*whole)
        return self._piece(axis, none, flats, self._now, truths)

    @property
    def origin(self) -> int:
        """The first position; there has been one."""
        return self._origin or 0

    def value_here(self, leaf: int) -> int:
        """The truth of a leaf at the last place so far."""
        truth = self._here[leaf]
        return int(truth.must) + int(truth.may)

    def _piece(
        self,
        axis: Axis,
        places: NDArray[np.int64],
        flats: dict[int, Flat],
        before: dict[int, Truth],
        truths: dict[int, Truth],
    ) -> Piece:
        for place, state in enumerate(self._plan.graph.nodes):
            if not self._flat[place]:
                truths[place] = self._stretches(place, state, axis, truths)
        return Piece(axis, places, flats, before, truths)

    # Formulas that look at one position.

    def _flats(self, columns: Columns, rows: int) -> dict[int, Flat]:
        made: dict[int, Flat] = {}
        graph = self._plan.graph
        self._reading.take(columns, rows)
        for place, state in enumerate(graph.nodes):
            if not self._flat[place]:
                continue
            if state.leaf is not None:
                made[place] = self._reading.of(state.leaf, state.unborn)
                continue
            operands = [made[operand] for operand in graph.operands[place]]
            at = _flat_value(state.op, [flat.at for flat in operands])
            between = at
            if any(flat.between is not flat.at for flat in operands):
                between = _flat_value(state.op, [flat.between for flat in operands])
            made[place] = Flat(at, between)
        return made

    def _laid_out(self, place: int, flat: Flat, axis: Axis, places: NDArray[np.int64]) -> Truth:
        """The stretches of a flat formula."""
        before = self._now.get(place, known_truth(False))
        steady = flat.between is flat.at or isinstance(axis, RowAxis)
        at, between = flat.at, flat.at if steady else flat.between
        must = _toggles(at.must, between.must, before.must, axis, places)
        if at.known and between.known and before.known:
            return known_truth(must)
        return Truth(must, _toggles(at.may, between.may, before.may, axis, places))

    # Formulas that look back, or depend on time.

    def _stretches(self, place: int, state: State, axis: Axis, truths: dict[int, Truth]) -> Truth:
        operands = [truths[operand] for operand in self._plan.graph.operands[place]]
        if isinstance(state.leaf, Elapsed):
            due = (self._origin or 0) + state.leaf.duration
            return known_truth(between(axis.place_from(due), axis.stop))
        match state.op:
            case StateOp.NOT:
                over = partial(complement, start=axis.start, stop=axis.stop)
                return negated(operands[0], over)
            case StateOp.AND:
                return combined(operands, partial(in_at_least, len(operands)))
            case StateOp.OR:
                return combined(operands, partial(in_at_least, 1))
            case StateOp.SURE:
                return known_truth(operands[0].must)
            case _:
                return self._memory[place].take(operands, axis)


Look = TypeVar("Look", Previous, Since)


class _Memory(Generic[Look]):
    """A node that looks back: one for what must hold, and one for what may where they differ."""

    def __init__(self, look: Look) -> None:
        self._must: Look = look
        self._may: Look = look

    def take(self, operands: list[Truth], axis: Axis) -> Truth:
        if self._may is self._must:
            if all(operand.known for operand in operands):
                return known_truth(self._must.take([truth.must for truth in operands], axis))
            self._may = self._must.copy()
        made = Truth(
            self._must.take([truth.must for truth in operands], axis),
            self._may.take([truth.may for truth in operands], axis),
        )
        if self._may.same(self._must):
            self._may = self._must
        return made


def _at_last(truth: Truth) -> Truth:
    must = bool(truth.must[-1])
    return known_truth(must) if truth.known else Truth(must, bool(truth.may[-1]))


def _at_rows(truth: Truth, rows: NDArray[np.int64]) -> NDArray[np.int64]:
    must: NDArray[np.int64] = truth.must[rows].astype(np.int64)
    return 2 * must if truth.known else must + truth.may[rows]


def _flat_value(op: StateOp, operands: list[Truth]) -> Truth:
    if op is StateOp.NOT:
        return negated(operands[0], np.logical_not)
    if op is StateOp.SURE:
        return known_truth(operands[0].must)
    sign = np.logical_and if op is StateOp.AND else np.logical_or
    return combined(operands, partial(reduce, sign))


def _toggles(at: Any, between: Any, before: bool, axis: Axis, places: NDArray[np.int64]) -> Toggles:
    """Where a truth per row holds, as stretches.

    Args:
        at: bool[n], at the rows.
        between: bool[n], behind each row; the same object if nothing changes there.
        before: the truth at the first place of the axis, if no row stands there.
        axis: of the piece.
        places: of the rows.
    """
    turns = np.empty(len(at), bool)
    turns[0] = at[0] != before
    np.not_equal(at[1:], between[:-1], out=turns[1:])
    changes = places[np.flatnonzero(turns)]
    if between is not at:
        # Behind a row that a next one follows at once nothing is: the changes there cancel out.
        fading = places[:-1][np.not_equal(at[:-1], between[:-1])] + 1
        changes = np.sort(np.concatenate((changes, fading)), kind="stable")
    edges = [changes]
    if before:
        edges.insert(0, np.array([axis.start], np.int64))
    made = np.concatenate(edges)
    twice = np.flatnonzero(made[1:] == made[:-1])
    if len(twice):
        made = np.delete(made, np.concatenate((twice, twice + 1)))
    if len(made) % 2:
        made = np.append(made, axis.stop)
    return made
