"""Results on the disk as they come, so that work which was ended in its midst goes on from there.

A journal is a file of lines, each an entry behind its checksum. Whatever ends the process that adds
to it, the entries before are whole; what is torn or damaged ends what is read.

>>> from tempfile import TemporaryDirectory
>>> with TemporaryDirectory() as folder:
...     path = Path(folder, "a.journal")
...     begin(path, [b"first"])
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


def entries(path: Path, *, all_of_them: bool = False) -> list[bytes] | None:
    """The entries of a journal, up to the first that is not whole; `None` if there is no file.

    With `all_of_them`, an entry that is not whole may only be the last, which was torn.

    Raises:
        OSError: it cannot be read.
        ValueError: another one is damaged.
    """
    try:
        lines = path.read_bytes().splitlines(keepends=True)
    except FileNotFoundError:
        return None
    found: list[bytes] = []
    for line in lines:
        entry = line[_WIDTH:-1]
        if _line(entry) != line:
            if all_of_them and line is not lines[-1]:
                raise ValueError(f"line {len(found) + 1} is damaged")
            break
        found.append(entry)
    return found


def begin(path: Path, first: Iterable[bytes]) -> None:
    """Write a journal of these entries; a file that is there goes.

    Raises:
        OSError: it cannot be written; nothing has changed.
    """
    place_whole(path, b"".join(map(_line, first)))


def add(path: Path, entry: bytes) -> None:
    """Add an entry, a line without its end: from now on it stays, also if the process is killed.

    Raises:
        OSError: it cannot be written; nothing has changed.
    """
    # Without a buffer: a killed process leaves the whole entry, or a torn last line that its
    # checksum tells.
    with path.open("ab", buffering=0) as file:
        end, rest = file.tell(), _line(entry)
        try:
            while rest:  # what a full disk has room for is written, and only the rest refused
                rest = rest[file.write(rest) :]
        except OSError:
            file.truncate(end)
            raise


class Journal(Struct, frozen=True):
    """Work that goes on from where it was ended."""

    path: Path  # of the journal that is added to
    shards: Sequence[Path] = ()  # journals of shards, from which something is known

    def keep(self, entry: object) -> None:
        """Write down what was done, as JSON: it stays, whatever ends this process.

        Raises:
            OSError: it cannot be written.
        """
        add(self.path, msgspec.json.encode(entry))

    def remove(self) -> None:
        """Delete the files, as all is done and written."""
        for path in (self.path, *self.shards):
            path.unlink(missing_ok=True)


def checksum(*inputs: object) -> str:
    """A checksum of what results depend on, rvmon and Python included."""
    # Another rvmon or Python may give other results: its journal must not be gone on with.
    own = list(contents(Path(__file__).parents[1]))
    return hashlib.sha256(json.dumps([*inputs, own, sys.version]).encode()).hexdigest()


_WIDTH = 9  # characters of a line before its entry


def _line(entry: bytes) -> bytes:
    return b"%08x %s\n" % (zlib.crc32(entry), entry)
