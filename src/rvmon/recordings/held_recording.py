"""Recordings that are gone through several times once their verdicts are known."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence, Set
from itertools import chain, pairwise
from typing import TYPE_CHECKING, Any

from rvmon.trace.sample import Outage, Sample

if TYPE_CHECKING:
    from rvmon.recordings.batch import Batch

MOST_HELD = 1_000_000
"""The most rows of columns that are held, some 33 bytes each; of more, all are read again."""

_SAMPLE = 10  # rows that take as much memory as a sample


class HeldRecording(Sequence[Sample]):
    """The samples of a recording; those of columns take a tenth of the memory of samples.

    Args:
        pieces: the recording, read once.
        outages: the stretches that were lost.
        again: reads it once more, where it is too long to be held; default: all of it is held.
    """

    def __init__(
        self,
        pieces: Iterable[Batch | Sample],
        outages: Sequence[Outage] = (),
        again: Callable[[], Iterable[Batch | Sample]] | None = None,
    ) -> None:
        self.outages = tuple(outages)
        self._again = again
        self._held: list[Batch | Sample] = []
        self._rest: Iterator[Batch | Sample] | None = iter(pieces)
        """What was not read yet; `None`: what comes behind those that are held must be read again,
        or there is nothing."""
        self._is_whole = False  # whether all is held
        weight = 0
        while again is None or weight <= MOST_HELD:
            piece = next(self._rest, None)
            if piece is None:
                self._is_whole = True
                break
            self._held.append(piece)
            weight += weight_of(piece)

    def pieces(self) -> Iterator[Batch | Sample]:
        """The pieces of the recording, from its begin."""
        if self._is_whole or self._again is None:
            return iter(self._held)
        rest, self._rest = self._rest, None
        return iter(self._again()) if rest is None else chain(self._held, rest)

    def __bool__(self) -> bool:
        """Whether there is any."""
        return any(map(rows_of, self._held))

    def __len__(self) -> int:
        """The number of rows, of which several may belong to one sample."""
        return sum(map(rows_of, self.pieces()))

    def __iter__(self) -> Iterator[Sample]:
        """The samples."""
        return chain.from_iterable(map(samples_of, self.pieces()))

    def __getitem__(self, place: Any) -> Any:
        """A sample; all are gone through, but for the first."""
        if place == 0:
            return next(chain.from_iterable(map(samples_of, self._held)))
        return list(self)[place]

    def is_longer_than(self, rows: int) -> bool:
        """Whether it has more rows than some, which are few enough to be held."""
        return not self._is_whole or sum(map(rows_of, self._held)) > rows


def held(samples: Iterable[Batch | Sample]) -> HeldRecording:
    """Samples as a held recording, or the one that they are."""
    return samples if isinstance(samples, HeldRecording) else HeldRecording(samples)


def weight_of(piece: Batch | Sample) -> int:
    """The number of rows of columns that take as much memory as a piece."""
    return _SAMPLE if isinstance(piece, Sample) else len(piece.times)


def rows_of(piece: Batch | Sample) -> int:
    """The number of rows of a piece."""
    return 1 if isinstance(piece, Sample) else len(piece.times)


def samples_of(piece: Batch | Sample) -> Iterator[Sample]:
    """The samples of a piece."""
    return iter((piece,)) if isinstance(piece, Sample) else piece.samples()


class UnknownWhileLost:
    """Makes names unknown while they are lost, piece by piece of a recording.

    Args:
        outages: the stretches that were lost.
        names: those that an outage of all names means.
    """

    def __init__(self, outages: Iterable[Outage], names: Set[str]) -> None:
        self._names = names
        self._waiting = deque(sorted(outages, key=lambda outage: outage.since))
        self._turns = sorted({t for one in self._waiting for t in (one.since, one.until)})
        self._lasting: list[tuple[int, Set[str]]] = []

    def parts(self, piece: Batch | Sample) -> Iterator[Batch | Sample]:
        """The parts of the next piece, and samples in which what is lost becomes unknown."""
        for part in _parts(piece, self._turns):
            first = part.t if isinstance(part, Sample) else int(part.times[0])
            while self._waiting and self._waiting[0].since <= first:
                loss = self._waiting.popleft()
                lost_names = self._names if loss.names is None else loss.names
                self._lasting.append((loss.until, lost_names))
                yield Sample(loss.since, dict.fromkeys(lost_names))
            # What comes at the last instant counts behind it.
            self._lasting = [(until, names) for until, names in self._lasting if first < until]
            lost = {name for _, names in self._lasting for name in names}
            yield part.without(lost) if lost else part


def _parts(piece: Batch | Sample, turns: Sequence[int]) -> Iterator[Batch | Sample]:
    """A piece, of which rows are cut apart where something is lost, or found."""
    if isinstance(piece, Sample) or not turns:
        yield piece
        return
    edges = sorted({0, len(piece.times), *piece.times.searchsorted(turns).tolist()})
    yield from (piece.cut(start, stop) for start, stop in pairwise(edges))
