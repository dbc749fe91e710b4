"""The last update of each signal, tracked while a recording is read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from typing import TYPE_CHECKING

from rvmon.recordings.coalesce import updates_in
from rvmon.trace.sample import Sample, Scalar, Value

if TYPE_CHECKING:
    from rvmon.recordings.batch import Batch

FOREVER = (1 << 63) - 1  # later than any tick
Update = tuple[int, Scalar]  # an instant in ticks, and the value; `None`: unknown


class LastUpdates:
    """Keeps the last update of some signals; of those in `ignoring`, unknown is no update."""

    def __init__(self, names: Set[str], ignoring: frozenset[str]) -> None:
        self._names = names
        self._ignoring = ignoring
        self._latest: dict[str, Update] = {}

    def add(self, pieces: Sequence[Batch | Sample]) -> None:
        """Take the next pieces of the recording."""
        wanted = set(self._names)
        for piece in reversed(pieces):  # the last piece mostly has an update of every signal
            for name, update in self.last_in(piece, wanted):
                self._latest[name] = update
                wanted.discard(name)
            if not wanted:
                return

    def until(self, instant: int, piece: Batch | Sample | None) -> Mapping[str, Update]:
        """By name, the last update up to an instant (ticks), which may lie in the next piece.

        `piece`: the next piece, which was not added yet; `None` at the end of the recording.
        """
        if piece is None or isinstance(piece, Sample):
            is_past = piece is not None and piece.t <= instant
            own = self.last_in(piece, self._names) if piece is not None and is_past else ()
        else:
            own = self.last_in(piece.up_to(instant), self._names)
        return {**self._latest, **dict(own)}

    def last_in(self, piece: Batch | Sample, names: Set[str]) -> Iterator[tuple[str, Update]]:
        """Yield the name and last update in a piece of each of some signals."""
        if isinstance(piece, Sample):
            values = updates_in(piece.values, self._ignoring)
            for name in names & values.keys():
                yield name, (piece.t, known(values[name]))
            return
        for name in names & piece.signals.keys():
            row = piece.signals[name].last_given
            if row is not None:
                [value] = piece.signals[name].of_rows(row, row + 1)
                yield name, (int(piece.times[row]), known(value))


def known(value: Value) -> Scalar:
    """The value of a signal as a scalar; `None` for NaN, or whatever is no scalar."""
    if isinstance(value, float) and value != value:  # NaN
        return None
    return value if isinstance(value, bool | int | float | str) else None


class ValuesAt:
    """The values of signals at requested instants, found while a recording is read.

    Args:
        names: the signals that may be requested.
        ignoring: see `LastUpdates`.
        stale_after: by name, the age (ticks) above which a value is unknown; `None`: never.
    """

    def __init__(
        self, names: Set[str], ignoring: frozenset[str], stale_after: Mapping[str, int | None]
    ) -> None:
        self.known: dict[tuple[int, str], Scalar] = {}  # by instant and name
        self._stale_after = stale_after
        self._updates = LastUpdates(names, ignoring)
        self._requests: dict[int, Set[str]] = {}
        self._next = FOREVER
        self._since: int | None = None

    def ask(self, instant: int, names: Set[str]) -> None:
        """Request signals at an instant (ticks); ignored if later pieces were taken already."""
        if self._since is None or instant >= self._since:
            self._requests[instant] = self._requests.get(instant, set()) | names
            self._next = min(self._next, instant)

    def take(self, pieces: Sequence[Batch | Sample]) -> None:
        """Take the next pieces of the recording, at least one."""
        last, place = last_of(pieces[-1]), 0
        while self._next < last:  # the last instant may have further updates in the next pieces
            passed = place
            while last_of(pieces[place]) <= self._next:
                place += 1
            self._updates.add(pieces[passed:place])
            self._settle(pieces[place])
        self._updates.add(pieces[place:])
        self._since = last

    def finish(self) -> None:
        """Settle all open requests at the end of the recording."""
        while self._requests:
            self._settle(None)

    def _settle(self, piece: Batch | Sample | None) -> None:
        """Find the values requested at the next instant, which may lie in `piece`."""
        instant = self._next
        updates = self._updates.until(instant, piece)
        for name in self._requests.pop(instant):
            # By the last update, not the last change: a repeated value is not stale.
            t, value = updates.get(name, (instant, None))
            limit = self._stale_after.get(name)
            is_stale = limit is not None and instant > t + limit
            self.known[instant, name] = None if is_stale else value
        self._next = min(self._requests, default=FOREVER)


def first_of(piece: Batch | Sample) -> int:
    """The first instant of a piece, ticks."""
    return piece.t if isinstance(piece, Sample) else int(piece.times[0])


def last_of(piece: Batch | Sample) -> int:
    """The last instant of a piece, ticks."""
    return piece.t if isinstance(piece, Sample) else int(piece.times[-1])
