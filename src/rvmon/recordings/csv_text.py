"""The text of a CSV file in stretches of whole lines, which other threads may read ahead."""

from __future__ import annotations

import io
import os
import re
from codecs import getincrementaldecoder
from collections import deque
from collections.abc import Callable, Generator, Iterator
from typing import TYPE_CHECKING, BinaryIO, Generic, TypeVar

from rvmon.errors import TraceError
from rvmon.native import extension
from rvmon.native.sources import CSV_FOLDER
from rvmon.recordings import places
from rvmon.recordings.csv_rows import split_lines

if TYPE_CHECKING:
    from concurrent.futures import Future

    from rvmon.native import _csv

    native_csv = _csv
else:
    native_csv = extension("_csv", CSV_FOLDER, "the reader of CSV")


_Result = TypeVar("_Result")

_MARK = b"\xef\xbb\xbf"  # the byte order mark of UTF-8, which some editors put before a text

_SMALL = 1 << 15
"""Bytes that are read first. The memory for a whole block comes from the system and goes back to
it, which for a small file takes as long as opening the file."""

_END = re.compile(rb"\r\n|\n|\r(?!\Z)")
"""The end of a line; a carriage return at the end of a block may be the first half of one."""


class CsvText(Generic[_Result]):
    """A text that is read in stretches, and the position up to which it was taken.

    A stretch ends with a line, mostly also with a row. If not, its last row is read again together
    with the next stretch.
    """

    def __init__(self, file: BinaryIO) -> None:
        size = min(_SMALL, places.BLOCK)
        first = file.read(size)
        if len(first) == size:
            first += file.read(places.BLOCK - size)
        self.is_whole = len(first) < places.BLOCK  # the first read has reached the end of the file
        self._stretches = stretches(first, file)
        self._read: Generator[tuple[bytes, Callable[[], _Result] | None], None, None]
        self._read = ((stretch, None) for stretch in self._stretches)
        # the current stretch; what another thread has found in the whole of it, if read ahead
        self.rest, self.result = next(self._read)
        self.start = len(_MARK) if self.rest.startswith(_MARK) else 0  # offset of text not taken
        self.line = 0  # the number of lines taken
        self.is_last = False  # whether there is no further stretch
        self.lost: frozenset[str] = frozenset()  # names made unknown, as the last line has no end

    def read_ahead(self, read: Callable[[bytes], _Result]) -> None:
        """Have other threads read further stretches."""
        self._read = read_ahead(self._stretches, read)

    def close(self) -> None:
        """Stop reading."""
        self._read.close()

    def read_on(self) -> bool:
        """Continue with the next stretch, before which text not taken is kept.

        Returns:
            False if the call before this one has already found the end of the text.

        Raises:
            TraceError: a row is too long.
        """
        if self.is_last:
            return False
        if len(self.rest) - self.start > places.LONGEST_LINE:
            self._refuse_long()
        further = next(self._read, None)
        self.is_last = further is None
        stretch, self.result = further or (b"", None)
        if self.start < len(self.rest):
            stretch, self.result = self.rest[self.start :] + stretch, None
        self.rest = stretch
        self.start = 0
        return True

    @property
    def is_ended(self) -> bool:
        """Whether this is the end of the text, and its last line has an end."""
        return self.is_last and self.rest[-1:] in (b"\n", b"\r", b"")

    def _refuse_long(self) -> None:
        rest = self.rest[self.start :].decode(errors="ignore")
        if len(rest) > places.LONGEST_LINE:
            lines = places.bounded_lines(io.StringIO(rest, newline=""), self.line)
            deque(split_lines(lines, self.line), 0)

    def lines(self) -> Iterator[str]:
        """Yield the next lines; each is taken when it is yielded."""
        looked_at = self.start
        while self.start < len(self.rest) or not self.is_last:
            found = _END.search(self.rest, looked_at)
            if found is not None or self.is_last:
                yield self.cut(len(self.rest) if found is None else found.end())
                looked_at = self.start
            else:
                # Search only new text, and the last byte, which may be half of a line end.
                looked_at = max(0, len(self.rest) - self.start - 1)
                self.read_on()

    def header(self) -> list[str]:
        """Take the header."""
        try:
            return next(split_lines(self.lines()))[1]
        except StopIteration:
            raise TraceError("is empty: expected a header with a time column `t`") from None

    def cut(self, end: int) -> str:
        """Take the text up to an offset."""
        taken = self.rest[self.start : end].decode()
        self.line += max(1, line_ends(taken))
        self.start = end
        return taken


def line_ends(text: str) -> int:
    """The number of line ends in a text: newlines, carriage returns, or both together."""
    return text.count("\n") + text.count("\r") - text.count("\r\n")


_Read = TypeVar("_Read")

MOST_THREADS = 4  # the most reading threads; more would only wait for the consumer of the results


def stretches(first: bytes, file: BinaryIO) -> Iterator[bytes]:
    r"""Yield a text in stretches of whole lines; a line longer than a block comes in several.

    The last stretch may lack the end of its line.

    Args:
        first: the first `places.BLOCK` bytes of the text; if there are fewer, `file` is not read.
        file: the rest of the text; a short read means its end.

    Raises:
        UnicodeDecodeError: the text is not UTF-8.

    >>> import io
    >>> list(stretches(b"t,p\n0,1\n1,", io.BytesIO()))
    [b't,p\n0,1\n1,']
    """
    decoder = getincrementaldecoder("utf-8")()
    tail, piece = b"", first
    passed = split = 0  # bytes before this piece, and those of them that begin a split character
    while piece:
        # Most texts are ASCII, which needs no decoder. A character may be split between two blocks.
        if split or not piece.isascii():
            try:
                decoder.decode(piece)
            except UnicodeDecodeError as error:
                error.start += passed - split
                raise
            split = len(decoder.getstate()[0])
        passed += len(piece)
        is_last = len(piece) < places.BLOCK
        if is_last and not split:
            yield tail + piece
            return
        whole = piece.rfind(b"\n") + 1 or len(piece)
        yield b"".join((tail, memoryview(piece)[:whole]))
        tail = piece[whole:]
        piece = b"" if is_last else file.read(places.BLOCK)
    decoder.decode(b"", final=True)
    yield tail


def read_ahead(
    found: Iterator[bytes], read: Callable[[bytes], _Read]
) -> Generator[tuple[bytes, Callable[[], _Read] | None], None, None]:
    """Yield stretches, each with a function that waits for the result of another thread's `read`.

    A stretch that ends within a line is not read ahead, and has `None` instead of the function.

    Args:
        found: the stretches; they are taken in order, one thread at a time, some in advance.
        read: reads a stretch; runs in several threads at once.
    """
    from concurrent.futures import ThreadPoolExecutor  # a small file needs none

    threads = min(MOST_THREADS, os.cpu_count() or 1)
    pool = ThreadPoolExecutor(threads, "rvmon-reads")
    waiting: deque[tuple[bytes, Future[_Read] | None]] = deque()
    further = pool.submit(next, found, None)
    try:
        while True:
            # An error in taking a stretch is raised after the stretches before it were yielded.
            while not waiting or (len(waiting) <= threads and further.exception() is None):
                stretch = further.result()
                if stretch is None:
                    break
                further = pool.submit(next, found, None)
                is_ended = stretch.endswith(b"\n")
                waiting.append((stretch, pool.submit(read, stretch) if is_ended else None))
            if not waiting:
                return
            stretch, one = waiting.popleft()
            yield stretch, None if one is None else one.result
    finally:
        del further  # the traceback of its error holds this frame
        for _, one in waiting:
            if one is not None:
                one.cancel()
        pool.shutdown()
