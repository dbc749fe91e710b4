"""A recording that is held in memory in columns, and read as samples."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, overload

from rvmon.readers.coalesce import Conflicts, coalesce
from rvmon.trace.sample import Sample

if TYPE_CHECKING:
    from rvmon.readers.batch import Batch


class HeldRecording(Sequence[Sample]):
    """The samples of a recording; those of columns take a tenth of the memory of samples.

    Args:
        pieces: of the recording, in order.
        events: the names that are events.

    Attributes:
        pieces: as given.
    """

    def __init__(self, pieces: Iterable[Batch | Sample], events: Container[str]) -> None:
        self.pieces = tuple(pieces)
        self._events = events

    def __len__(self) -> int:
        """How many rows there are, of which some may be of one sample."""
        return sum(1 if isinstance(one, Sample) else len(one.times) for one in self.pieces)

    def __iter__(self) -> Iterator[Sample]:
        """The samples."""
        for piece in self.pieces:
            if isinstance(piece, Sample):
                yield piece
            else:
                rows = piece.rows(0, len(piece.times))
                yield from coalesce(rows, self._events, Conflicts())

    @overload
    def __getitem__(self, place: int) -> Sample: ...
    @overload
    def __getitem__(self, place: slice) -> list[Sample]: ...
    def __getitem__(self, place: int | slice) -> Sample | list[Sample]:
        """A sample; all are gone through, but for the first."""
        return next(iter(self)) if place == 0 else list(self)[place]
