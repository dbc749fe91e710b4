"""A recording that is held in memory, in the pieces that it was read in."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence, Set
from itertools import pairwise
from typing import Any

from rvmon.recordings.batch import Batch
from rvmon.trace.sample import Outage, Sample


class HeldRecording(Sequence[Sample]):
    """The samples of a recording; those of columns take a tenth of the memory of samples.

    Args:
        pieces: of the recording, in order.
        outages: its outages.
    """

    def __init__(self, pieces: Iterable[Batch | Sample], outages: Sequence[Outage] = ()) -> None:
        self.pieces = tuple(pieces)
        self.outages = tuple(outages)

    def __len__(self) -> int:
        """The number of rows, of which several may belong to one sample."""
        return sum(1 if isinstance(piece, Sample) else len(piece.times) for piece in self.pieces)

    def __iter__(self) -> Iterator[Sample]:
        """The samples."""
        for piece in self.pieces:
            if isinstance(piece, Sample):
                yield piece
            else:
                yield from piece.samples()

    def __getitem__(self, place: Any) -> Any:
        """A sample; all are gone through, but for the first."""
        return next(iter(self)) if place == 0 else list(self)[place]

    def as_known(self, names: Set[str]) -> Iterator[Batch | Sample]:
        """The pieces, in which names are unknown while they are lost.

        Args:
            names: all that a recording without names may lose.
        """
        waiting = deque(sorted(self.outages, key=lambda outage: outage.since))
        turns = sorted({t for outage in waiting for t in (outage.since, outage.until)})
        lasting: list[tuple[int, Set[str]]] = []
        for piece in self.pieces:
            for part in _parts(piece, turns):
                first = part.t if isinstance(part, Sample) else int(part.times[0])
                while waiting and waiting[0].since <= first:
                    one = waiting.popleft()
                    own = names if one.names is None else one.names
                    lasting.append((one.until, own))
                    yield Sample(one.since, dict.fromkeys(own))
                # What comes at the last instant counts behind it.
                lasting = [(until, own) for until, own in lasting if first < until]
                lost = {name for _, own in lasting for name in own}
                yield part.without(lost) if lost else part


def _parts(piece: Batch | Sample, turns: Sequence[int]) -> Iterator[Batch | Sample]:
    """A piece, of which rows are cut apart where something is lost, or found."""
    if isinstance(piece, Sample) or not turns:
        yield piece
        return
    edges = sorted({0, len(piece.times), *piece.times.searchsorted(turns).tolist()})
    yield from (piece.cut(start, stop) for start, stop in pairwise(edges))
