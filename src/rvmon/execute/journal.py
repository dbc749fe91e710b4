"""Journals: results written to disk as they come, so that interrupted work can be resumed.

A journal is a file with one entry per line, preceded by its checksum. Whatever ends the process
that writes it, all earlier entries are intact; reading stops at a truncated or damaged line.

>>> from tempfile import TemporaryDirectory
>>> with TemporaryDirectory() as folder:
...     path = Path(folder, "a.journal")
...     create(path, [b"first"])
...     add(path, b"second")
...     _ = path.write_bytes(path.read_bytes() + b"0123456")
...     entries(path)
[b'first', b'second']
"""

from __future__ import annotations

import hashlib
import json
import sys
import zlib
from collections.abc import Iterable, Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from rvmon.files import contents, place_whole


def entries(path: Path, *, strict: bool = False) -> list[bytes] | None:
    """The entries of a journal before the first damaged one; `None` if there is no file.

    With `strict`, only the last entry may be damaged, as a killed writer truncates it.

    Raises:
        OSError: the file cannot be read.
        ValueError: with `strict`, an entry before the last is damaged.
    """
    try:
        lines = path.read_bytes().splitlines(keepends=True)
    except FileNotFoundError:
        return None
    found: list[bytes] = []
    for line in lines:
        entry = line[_WIDTH:-1]
        if _line(entry) != line:
            if strict and line is not lines[-1]:
                raise ValueError(f"line {len(found) + 1} is damaged")
            break
        found.append(entry)
    return found


def create(path: Path, first: Iterable[bytes]) -> None:
    """Write a new journal with these entries; an existing file is replaced.

    Raises:
        OSError: the file cannot be written; nothing has changed.
    """
    place_whole(path, b"".join(map(_line, first)))


def add(path: Path, entry: bytes) -> None:
    """Append an entry, which contains no line end; it survives a kill of this process.

    Raises:
        OSError: the file cannot be written; nothing has changed.
    """
    # Without a buffer, a killed process leaves either the whole entry or a truncated last line,
    # which does not match its checksum.
    with path.open("ab", buffering=0) as file:
        end, rest = file.tell(), _line(entry)
        try:
            while rest:  # a nearly full disk takes a part first and raises only for the rest
                rest = rest[file.write(rest) :]
        except OSError:
            file.truncate(end)
            raise


class Journal(Struct, frozen=True):
    """The journal of resumable work."""

    path: Path  # the journal to which entries are appended
    shards: Sequence[Path] = ()  # journals of shards from which results were taken

    def keep(self, entry: object) -> None:
        """Append a result as JSON; it survives whatever ends this process.

        Raises:
            OSError: the file cannot be written.
        """
        add(self.path, msgspec.json.encode(entry))

    def remove(self) -> None:
        """Delete the files; to be called when all results are in their final place."""
        for path in (self.path, *self.shards):
            path.unlink(missing_ok=True)


def checksum(*inputs: object) -> str:
    """A checksum of all that results depend on: `inputs`, the sources of rvmon, and Python."""
    # Another rvmon or Python may give other results, so it must not continue this journal.
    own = list(contents(Path(__file__).parents[1]))
    return hashlib.sha256(json.dumps([*inputs, own, sys.version]).encode()).hexdigest()


_WIDTH = 9  # characters of a line before its entry


def _line(entry: bytes) -> bytes:
    return b"%08x %s\n" % (zlib.crc32(entry), entry)
