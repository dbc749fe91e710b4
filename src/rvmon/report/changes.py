"""The changes of signals and events over a recording; kept in columns if the input has columns."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from itertools import pairwise
from typing import TYPE_CHECKING, Any, overload

from msgspec import Struct

from rvmon.language.checked.specification import CheckedSpec
from rvmon.recordings.coalesce import updates_in
from rvmon.recordings.held_recording import HeldRecording, UnknownWhileLost, held
from rvmon.recordings.last_updates import known
from rvmon.trace.sample import Sample, Scalar, Value

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.recordings.batch import Batch, Cells

ValuesAt = tuple["NDArray[Any]", "NDArray[Any]"]
"""Values, and whether each is known; before the first change none is."""

_DENSE = 8  # with more changes per place than this, only extremes are drawn


class Course(Sequence[tuple[int, Scalar]]):
    """A sequence of changes, held as columns; each pair is created on access.

    Args:
        times: int64[n] ticks, ascending.
        values: array[n] of numbers, truth values or texts.
        hidden: bool[n], true where the value became unknown.
    """

    def __init__(self, times: NDArray[Any], values: NDArray[Any], hidden: NDArray[Any]) -> None:
        self._columns = times, values, hidden

    @classmethod
    def of(cls, changes: Sequence[tuple[int, Scalar]]) -> Course:
        """Convert changes to columns."""
        import numpy as np

        # `False` stands for unknown values, so that an array of truth values stays boolean.
        values = [False if value is None else value for _, value in changes]
        texts = any(isinstance(value, str) for value in values)
        return cls(
            np.array([t for t, _ in changes], np.int64),
            np.array(values, object if texts else None),
            np.array([value is None for _, value in changes], bool),
        )

    @classmethod
    def joined(cls, courses: Sequence[Course]) -> Course:
        """The concatenation of courses."""
        import numpy as np

        return cls(*map(np.concatenate, zip(*(course._columns for course in courses), strict=True)))

    def __len__(self) -> int:
        return len(self._columns[0])

    @overload
    def __getitem__(self, place: int) -> tuple[int, Scalar]: ...
    @overload
    def __getitem__(self, place: slice) -> Course: ...
    def __getitem__(self, place: int | slice) -> tuple[int, Scalar] | Course:
        times, values, hidden = self._columns
        if isinstance(place, slice):
            return Course(times[place], values[place], hidden[place])
        return int(times[place]), None if hidden[place] else _plain(values[place])

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]  # unhashable like a list, as it equals sequences

    def shifted(self, ticks: int) -> Course:
        """The changes moved by some ticks."""
        times, values, hidden = self._columns
        return Course(times + ticks, values, hidden)

    def count_until(self, instant: int) -> int:
        """The number of changes up to an instant, inclusive."""
        return int(self._columns[0].searchsorted(instant, "right"))

    def values_at(self, instants: NDArray[Any]) -> ValuesAt:
        """The values at some instants, in the same shape."""
        times, values, hidden = self._columns
        places = times.searchsorted(instants, "right") - 1
        if not len(times):
            return places, places >= 0
        return values[places], (places >= 0) & ~hidden[places]

    @property
    def has_unknown(self) -> bool:
        """Whether the value becomes unknown at some change."""
        return bool(self._columns[2].any())

    def outlined(self, places: int) -> Course:
        """A thinned version: first, last and extreme values in each of `places` equal stretches.

        Changes to unknown and back are all kept.
        """
        import numpy as np

        times, values, hidden = self._columns
        if len(times) <= _DENSE * places:
            return self
        edges = np.linspace(float(times[0]), float(times[-1]), places + 1)
        bounds = [0, *np.searchsorted(times, edges[1:-1]).tolist(), len(times)]
        kept = {0, len(times) - 1}
        lows, highs = np.where(hidden, np.inf, values), np.where(hidden, -np.inf, values)
        for start, stop in pairwise(bounds):
            if start < stop:
                low, high = int(lows[start:stop].argmin()), int(highs[start:stop].argmax())
                kept |= {start, start + low, start + high, stop - 1}
        turns = np.flatnonzero(hidden[1:] != hidden[:-1])
        rows = np.array(sorted({*kept, *turns.tolist(), *(turns + 1).tolist()}))
        return Course(times[rows], values[rows], hidden[rows])


class Looks(Struct, frozen=True):
    """The parts of a run for which changes are needed."""

    # stretches of time, ticks, both ends included; `None`: the whole run
    stretches: Sequence[tuple[int, int]] | None = None
    everywhere: Set[str] = frozenset()  # names that are needed over the whole run


EVERYWHERE = Looks()


def changes_of(
    spec: CheckedSpec, samples: Iterable[Sample], looks: Looks = EVERYWHERE
) -> Mapping[str, Changes]:
    """The changes of each signal and event of a run by name, complete within `looks`.

    Elsewhere only some changes are kept, to save memory.
    """
    noted = RunChanges(spec, looks)
    for _ in noted.passing(held(samples)):
        pass
    return noted.by_name


class RunChanges:
    """Collects the changes of signals and events, piece by piece, in order."""

    def __init__(self, spec: CheckedSpec, looks: Looks) -> None:
        self._everywhere = looks.everywhere
        self._to_come = None if looks.stretches is None else deque(sorted(looks.stretches))
        self._signals = spec.signals
        self._ignoring = spec.ignoring
        stale = {name: signal.stale_after for name, signal in spec.signals.items()}
        # the changes collected so far
        self.by_name = {name: Changes(stale.get(name)) for name in (*spec.signals, *spec.events)}
        # by signal, the last update outside the needed parts, which is not added yet
        self._waiting: dict[str, tuple[int, Value]] = {}

    def passing(self, run: HeldRecording) -> Iterator[Batch | Sample]:
        """Pass the pieces of the run through, and collect their changes."""
        known = UnknownWhileLost(run.outages, self.by_name.keys())
        for piece in run.pieces():
            for part in known.parts(piece):
                self._add(part)
            yield piece
        self._settle()

    def _settle(self) -> None:
        """Add the last updates before a needed part: they are the values at its start."""
        for name, (t, value) in self._waiting.items():
            self.by_name[name].add(t, value, is_signal=True)
        self._waiting.clear()

    def _add(self, piece: Batch | Sample) -> None:
        if isinstance(piece, Sample):
            to_come = len(self._to_come or ())
            is_seen = self._looks_at(piece.t, piece.t)
            # The second case is a stretch without samples that was passed.
            if is_seen or len(self._to_come or ()) < to_come:
                self._settle()
            for name, value in updates_in(piece.values, self._ignoring).items():
                if name in self.by_name and (is_seen or name in self._everywhere):
                    self.by_name[name].add(piece.t, value, is_signal=name in self._signals)
                elif name in self._signals:
                    self._waiting[name] = piece.t, value
            return
        self._settle()
        is_seen = not len(piece.times) or self._looks_at(int(piece.times[0]), int(piece.times[-1]))
        for name in self.by_name.keys() & piece.signals.keys():
            cells = piece.signals[name]
            if is_seen or name in self._everywhere:
                self.by_name[name].add_cells(piece, cells)
            elif (row := cells.last_given) is not None:  # the value at the start of the next piece
                self.by_name[name].add_cells(piece.cut(row, row + 1), cells.cut(row, row + 1))
        for name in self.by_name.keys() & piece.events.keys():
            if is_seen or name in self._everywhere:
                self.by_name[name].add_occurrences(piece.times, piece.events[name].states)

    def _looks_at(self, first: int, last: int) -> bool:
        """Whether any instant from `first` to `last` is needed; calls must be in order of time."""
        to_come = self._to_come
        while to_come and to_come[0][1] < first:
            to_come.popleft()
        return to_come is None or bool(to_come and to_come[0][0] <= last)


class Changes:
    """The changes of one name; a signal becomes unknown `stale_after` ticks after an update."""

    def __init__(self, stale_after: int | None) -> None:
        self._stale_after = stale_after
        self._last: int | None = None
        self._known: Scalar = None
        self._changes: list[tuple[int, Scalar]] = []
        self._courses: list[Course] = []

    def add(self, t: int, value: Value, *, is_signal: bool) -> None:
        """Add an update."""
        if is_signal:
            self._add_value(t, known(value))
        elif value is not False:
            self._changes.append((t, None if value is None else True))

    def _add_value(self, t: int, known: Scalar) -> None:
        self._grow_stale(t)
        if self._last is None or self._known != known:
            self._changes.append((t, known))
        self._last, self._known = t, known

    def _grow_stale(self, t: int | None) -> None:
        """Add the change to unknown if the value goes stale before `t`; `None`: before the end."""
        if self._stale_after is None or self._last is None or self._known is None:
            return
        # A value is still known `stale_after` ticks after its update, and unknown one tick later.
        stale_at = self._last + self._stale_after + 1
        if t is None or t > stale_at:
            self._changes.append((stale_at, None))
            self._known = None

    def add_cells(self, batch: Batch, cells: Cells) -> None:
        """Add the updates of a signal in rows."""
        import numpy as np

        from rvmon.recordings.batch import last_given

        rows = last_given(batch, cells)
        if not len(rows):
            return
        times, values = batch.times[rows], cells.values[rows]
        if cells.labels is not None:
            values = np.array(cells.labels, object)[values]
        unknown = cells.unknown
        hidden = np.zeros(len(rows), bool) if unknown is None else unknown[rows]
        # The first row is compared with the value before this piece, the others with each other.
        self._add_value(int(times[0]), None if hidden[0] else _plain(values[0]))
        differs = (values[1:] != values[:-1]) & ~(hidden[1:] & hidden[:-1])
        differs |= hidden[1:] != hidden[:-1]
        if self._stale_after is not None:
            aged = (np.diff(times) > self._stale_after + 1) & ~hidden[:-1]
            # After a stale value, any known value is a change, even an equal one, and an unknown
            # one is not.
            differs = np.where(aged, ~hidden[1:], differs)
        else:
            aged = np.zeros(len(times) - 1, bool)
        # Merge by row: a value going stale after a row precedes the change at the next one.
        kept = np.flatnonzero(differs) + 1
        gone = np.flatnonzero(aged)
        order = np.argsort(np.concatenate([2 * kept, 2 * gone + 1]), kind="stable")
        changed = np.concatenate([times[kept], times[gone] + (self._stale_after or 0) + 1])
        column = changed[order], np.concatenate([values[kept], values[gone]])[order]
        self._settle()
        self._courses.append(Course(*column, np.concatenate([hidden[kept], aged[gone]])[order]))
        self._last = int(times[-1])
        self._known = None if hidden[-1] else _plain(values[-1])

    def add_occurrences(self, times: NDArray[Any], states: NDArray[Any]) -> None:
        """Add the occurrences of an event in rows; at equal instants a sure one wins."""
        from rvmon.recordings.batch import UNKNOWN, YES

        may = (states == UNKNOWN) | (states == YES)
        occurrences: dict[int, Scalar] = {}
        for t, state in zip(times[may].tolist(), states[may].tolist(), strict=True):
            occurrences[t] = True if state == YES else occurrences.get(t)
        self._changes += occurrences.items()

    def _settle(self) -> None:
        """Move the changes added one by one into columns."""
        if self._changes:
            self._courses.append(Course.of(self._changes))
            self._changes = []

    def ended(self) -> Course:
        """All changes of a signal, or all sure and possible occurrences of an event."""
        self._grow_stale(None)
        self._settle()
        if len(self._courses) != 1:
            self._courses = [Course.joined(self._courses or [Course.of(())])]
        return self._courses[0]


def _plain(value: Any) -> Scalar:
    scalar: Scalar = value.item() if hasattr(value, "item") else value
    return scalar
