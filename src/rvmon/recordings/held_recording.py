"""A recording kept so that reports can read it again after judging."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence, Set
from itertools import chain, pairwise
from typing import TYPE_CHECKING, Any

from rvmon.trace.sample import Outage, Sample

if TYPE_CHECKING:
    from rvmon.recordings.batch import Batch

MOST_HELD = 1_000_000
"""Longer recordings are re-read instead of held in memory (a row of a batch takes 33 bytes)."""

_SAMPLE = 10  # a sample takes as much memory as this many rows of a batch


class HeldRecording(Sequence[Sample]):
    """The samples of a recording, held as batches where possible: a tenth of the memory.

    Args:
        pieces: the recording, which is read once.
        outages: its outages.
        again: reads the recording once more if it is too long to be held; `None`: it is held whole.
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
        """Iterator over the pieces not read yet, or `None` once it was handed out."""
        self._is_whole = False  # whether all pieces are held
        weight = 0
        while again is None or weight <= MOST_HELD:
            piece = next(self._rest, None)
            if piece is None:
                self._is_whole = True
                break
            self._held.append(piece)
            weight += weight_of(piece)

    def pieces(self) -> Iterator[Batch | Sample]:
        """The pieces of the recording, from its start."""
        if self._is_whole or self._again is None:
            return iter(self._held)
        rest, self._rest = self._rest, None
        return iter(self._again()) if rest is None else chain(self._held, rest)

    def __bool__(self) -> bool:
        """Whether the recording has a row."""
        return any(map(rows_of, self._held))

    def __len__(self) -> int:
        """The number of rows, several of which may make up one sample."""
        return sum(map(rows_of, self.pieces()))

    def __iter__(self) -> Iterator[Sample]:
        """Yield the samples."""
        return chain.from_iterable(map(samples_of, self.pieces()))

    def __getitem__(self, place: Any) -> Any:
        """A sample, or a slice; except for the first sample, this reads the whole recording."""
        if place == 0:
            return next(chain.from_iterable(map(samples_of, self._held)))
        return list(self)[place]

    def is_longer_than(self, rows: int) -> bool:
        """Whether the recording has more than `rows` rows, or is too long to be held."""
        return not self._is_whole or sum(map(rows_of, self._held)) > rows


def held(samples: Iterable[Batch | Sample]) -> HeldRecording:
    """Hold samples in memory; a held recording is returned as it is."""
    return samples if isinstance(samples, HeldRecording) else HeldRecording(samples)


def weight_of(piece: Batch | Sample) -> int:
    """The memory that a piece takes, in rows of a batch."""
    return _SAMPLE if isinstance(piece, Sample) else len(piece.times)


def rows_of(piece: Batch | Sample) -> int:
    """The number of rows of a piece; a sample counts as one."""
    return 1 if isinstance(piece, Sample) else len(piece.times)


def samples_of(piece: Batch | Sample) -> Iterator[Sample]:
    """The samples of a piece."""
    return iter((piece,)) if isinstance(piece, Sample) else piece.samples()


class UnknownWhileLost:
    """Makes names unknown during outages, piece by piece of a recording.

    Args:
        outages: the outages of the recording.
        names: the names concerned by an outage of all names.
    """

    def __init__(self, outages: Iterable[Outage], names: Set[str]) -> None:
        self._names = names
        self._waiting = deque(sorted(outages, key=lambda outage: outage.since))
        # the instants at which batches are cut, as names get lost or are no longer lost
        self._turns = sorted({t for one in self._waiting for t in (one.since, one.until)})
        self._lasting: list[tuple[int, Set[str]]] = []  # current outages: end and names

    def parts(self, piece: Batch | Sample) -> Iterator[Batch | Sample]:
        """Yield the next piece in parts, without the names that are lost there.

        A sample at the start of an outage makes its names unknown. Pieces must come in order.
        """
        for part in _parts(piece, self._turns):
            first = part.t if isinstance(part, Sample) else int(part.times[0])
            while self._waiting and self._waiting[0].since <= first:
                loss = self._waiting.popleft()
                lost_names = self._names if loss.names is None else loss.names
                self._lasting.append((loss.until, lost_names))
                yield Sample(loss.since, dict.fromkeys(lost_names))
            # An update at the last instant of an outage counts, as if it came after the outage.
            self._lasting = [(until, names) for until, names in self._lasting if first < until]
            lost = {name for _, names in self._lasting for name in names}
            yield part.without(lost) if lost else part


def _parts(piece: Batch | Sample, turns: Sequence[int]) -> Iterator[Batch | Sample]:
    """Yield a piece; a batch is cut where an outage starts or ends (`turns`, ticks)."""
    if isinstance(piece, Sample) or not turns:
        yield piece
        return
    edges = sorted({0, len(piece.times), *piece.times.searchsorted(turns).tolist()})
    yield from (piece.cut(start, stop) for start, stop in pairwise(edges))
