"""A finished trace as it is to be judged: pieces of rows, and samples."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import TYPE_CHECKING, Any

from rvmon.trace.sample import Outage, Recording, Sample

if TYPE_CHECKING:
    from rvmon.readers.batch import Batch


@dataclass(frozen=True, slots=True)
class Source:
    """A finished trace, and how it is to be taken.

    Attributes:
        recording: gives samples; one that has columns has `pieces` as well: see
            `rvmon.readers.recording.FileRecording`.
        until: the end of the trace in ticks, if it is not its last sample.
        is_cut: whether what comes after that end is left out.
        read: gives the samples of the recording.
        shown: what samples and batches go through as they are read.
    """

    recording: Recording
    until: int | None = None
    is_cut: bool = False
    read: Callable[[Any], Iterable[Sample]] = iter
    shown: Callable[[Iterator[Any]], Iterator[Any]] = iter

    @property
    def names(self) -> frozenset[str] | None:
        """The signals and events that have a source; `None`: all."""
        return self.recording.names

    @property
    def end(self) -> int | None:
        """The end of the trace in ticks; `None`: its last sample."""
        return self.recording.end if self.until is None else self.until

    @property
    def outages(self) -> Sequence[Outage]:
        """The stretches that were lost."""
        return getattr(self.recording, "outages", ())

    def samples(self) -> Iterator[Sample]:
        """The samples; what lies behind the end is not read, and may be broken."""
        until, samples = self.until, self.shown(iter(self.read(self.recording)))
        if until is None or not self.is_cut:
            return samples
        return takewhile(lambda sample: sample.t <= until, samples)

    def pieces(self) -> Iterator[Batch | Sample]:
        """The recording in order: rows as columns where it has such, else samples."""
        read = getattr(self.recording, "pieces", None)
        if read is None or self.read is not iter:
            yield from self.samples()
            return
        until = self.until if self.is_cut else None
        for piece in self.shown(read()):
            if until is None:
                yield piece
            elif isinstance(piece, Sample):
                if piece.t > until:
                    return
                yield piece
            else:
                own = piece.up_to(until)
                yield own
                if len(own.times) < len(piece.times):
                    return
