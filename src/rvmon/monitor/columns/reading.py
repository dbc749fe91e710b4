"""Leaves of state formulas along a trace that is taken in pieces: what rows say, and since when."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.formula.numeric import signals_of
from rvmon.formula.state import FALSE, TRUE, UNKNOWN, Leaf, Lost, State, Unborn
from rvmon.monitor.columns.axis import FAR
from rvmon.monitor.columns.leaves import Columns, NotByColumnsError, Truth, compared, known_truth
from rvmon.spec.checked.formula import (
    Bound,
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    Probe,
    ProbeAtom,
    SignalAtom,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Bits = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Flat:
    """A formula that looks at one position: its truth per row.

    Attributes:
        at: at the rows.
        between: at the positions behind each row, before the next; the same object if it is so.
    """

    at: Truth
    between: Truth


def steady(truth: Truth) -> Flat:
    """What stays as it is until the next row."""
    return Flat(truth, truth)


class Reading:
    """Reads leaves off the rows.

    Args:
        nodes: with the leaves.
        names: of the columns: signals that every row updates, events.
    """

    def __init__(self, nodes: Iterable[State], names: frozenset[str]) -> None:
        read = (_signals(node.leaf) for node in nodes if node.leaf is not None)
        self._births: dict[str, int] = {name: FAR for own in read for name, _ in own}
        """By signal the row of its first known value."""
        self._names = names
        self._columns: Columns = {}
        self._raw: dict[SignalAtom | Compare, Truth] = {}
        self._row = 0
        self._rows = 0

    def take(self, columns: Columns, rows: int) -> None:
        """Go on with rows."""
        self._row += self._rows
        self._columns, self._rows = columns, rows
        self._raw.clear()
        for name, birth in self._births.items():
            if birth == FAR and name in self._names:
                self._births[name] = min(self._row + first_known(columns[name]), FAR)

    def of(self, leaf: Leaf, unborn: int) -> Flat:
        """The truth of a leaf.

        Args:
            leaf: that looks at one position.
            unborn: the truth of an atom over signals before their birth.

        Raises:
            NotByColumnsError: it has to be read sample by sample.
        """
        rows, names, columns = self._rows, self._names, self._columns
        no, yes = np.zeros(rows, bool), np.ones(rows, bool)
        match leaf:
            case Constant(value=value):
                return steady(known_truth(yes if value else no))
            case SignalAtom() | Compare():
                return steady(self._born(leaf, unborn))
            case Unborn(signals=signals):
                return steady(known_truth(self._is_unborn(signals)))
            case Lost():
                return steady(Truth(no, yes))
            case EventAtom(name=name):
                if name not in names:
                    return steady(Truth(no, yes))
                return Flat(known_truth(columns[name]), known_truth(no))
            case ProbeAtom(probe=Probe.KNOWN, name=name):
                if name not in names:
                    return steady(known_truth(no))
                values = columns[name]
                return steady(known_truth(values == values if values.dtype.kind == "f" else yes))
            case ProbeAtom(probe=Probe.UPDATED, name=name):
                if name not in names:
                    return steady(Truth(no, yes))
                return Flat(known_truth(yes), known_truth(no))
            case BoundAtom(bound=Bound.START):
                no[0] = self._row == 0
                return Flat(known_truth(no), known_truth(np.zeros(rows, bool)))
            case _:
                raise NotByColumnsError

    def _truth(self, atom: SignalAtom | Compare) -> Truth:
        """The truth of an atom over signals, born or not."""
        found = self._raw.get(atom)
        if found is None:
            if isinstance(atom, Compare):
                found = compared(atom, self._columns, self._rows)
            elif atom.name in self._names:
                found = known_truth(self._columns[atom.name])
            else:
                found = Truth(np.zeros(self._rows, bool), np.ones(self._rows, bool))
            self._raw[atom] = found
        return found

    def _born(self, atom: SignalAtom | Compare, unborn: int) -> Truth:
        truth = self._truth(atom)
        if truth.known or unborn == UNKNOWN:
            return truth
        before = self._is_unborn(_signals(atom)) & (truth.must != truth.may)
        if not before.any():
            return truth
        must = truth.must | before if unborn == TRUE else truth.must
        may = truth.may & ~before if unborn == FALSE else truth.may
        return known_truth(must) if np.array_equal(must, may) else Truth(must, may)

    def _is_unborn(self, signals: Iterable[tuple[str, bool]]) -> Bits:
        """Per row whether some signal has had no value, or update after it, that is asked for."""
        birth = max((self._births[name] + moved for name, moved in signals), default=0)
        made = np.zeros(self._rows, bool)
        made[: max(birth - self._row, 0)] = True
        return made


def _signals(leaf: Leaf) -> Sequence[tuple[str, bool]]:
    match leaf:
        case SignalAtom() | Compare():
            return tuple(signals_of(leaf).items())
        case Unborn(signals=signals):
            return signals
        case _:
            return ()


def first_known(values: NDArray[Any]) -> int:
    """The first place at which a column is known; `FAR` if there is none."""
    if values.dtype.kind != "f" or values[0] == values[0]:
        return 0
    known = values == values
    first = int(np.argmax(known))
    return first if known[first] else FAR
