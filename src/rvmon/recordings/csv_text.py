"""The text of a CSV, in stretches, and what of it was taken."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Generator, Iterator
from typing import BinaryIO, Generic, TypeVar

from rvmon.recordings import places
from rvmon.recordings.ahead import read_ahead, stretches
from rvmon.recordings.csv_rows import split_lines

_Found = TypeVar("_Found")

_MARK = b"\xef\xbb\xbf"
"""The byte order mark of UTF-8, with which some editors begin a text."""

_END = re.compile(rb"\r\n|\n|\r(?!\Z)")
"""The end of a line; a carriage return at the end of a block may be half of one."""


class CsvText(Generic[_Found]):
    """A text that is taken in stretches, and what of one is not taken yet.

    Mostly the end of a line is that of a row. Where it is not, what lies behind it is read again.

    Args:
        file: is read from its start.

    Attributes:
        is_whole: whether all of the file was read at once, so that nothing more is read of it.
        found: gives what was found in all of `rest`, if that was read ahead.

    Raises:
        UnicodeDecodeError: it is no text; so does whatever reads on.
    """

    def __init__(self, file: BinaryIO) -> None:
        first = file.read(places.BLOCK)
        self.is_whole = len(first) < places.BLOCK
        self._stretches = stretches(first, file)
        self._read: Generator[tuple[bytes, Callable[[], _Found] | None], None, None]
        self._read = ((stretch, None) for stretch in self._stretches)
        self.rest, self.found = next(self._read)
        self.start = len(_MARK) if self.rest.startswith(_MARK) else 0
        self.line = 0
        self.is_last = False

    def read_ahead(self, read: Callable[[bytes], _Found]) -> None:
        """Have further stretches read by other threads."""
        self._read = read_ahead(self._stretches, read)

    def close(self) -> None:
        """Read no further."""
        self._read.close()

    def read_on(self) -> bool:
        """Go on to a further stretch; false: there was none before, either."""
        if self.is_last:
            return False
        if len(self.rest) - self.start > places.LONGEST_LINE:
            self._refuse_long()
        further = next(self._read, None)
        self.is_last = further is None
        stretch, self.found = further or (b"", None)
        if self.start < len(self.rest):
            stretch, self.found = self.rest[self.start :] + stretch, None
        self.rest = stretch
        self.start = 0
        return True

    @property
    def is_ended(self) -> bool:
        """Whether it is read to its end, and its last line has one."""
        return self.is_last and self.rest[-1:] in (b"\n", b"\r", b"")

    def _refuse_long(self) -> None:
        rest = self.rest[self.start :].decode(errors="ignore")
        if len(rest) > places.LONGEST_LINE:
            for _ in split_lines(places.bounded_lines(io.StringIO(rest, newline="")), self.line):
                pass

    def lines(self) -> Iterator[str]:
        """The next lines, each taken as it is given out."""
        looked_at = self.start
        while self.start < len(self.rest) or not self.is_last:
            found = _END.search(self.rest, looked_at)
            if found is not None or self.is_last:
                yield self.cut(len(self.rest) if found is None else found.end())
                looked_at = self.start
            else:
                looked_at = max(0, len(self.rest) - self.start - 1)
                self.read_on()

    def cut(self, end: int) -> str:
        """Take what lies before a place."""
        taken = self.rest[self.start : end].decode()
        self.line += max(1, taken.count("\n") + taken.count("\r") - taken.count("\r\n"))
        self.start = end
        return taken
