"""An archive whose bytes follow from what it holds: a zip file, sorted, without stamps of time.

Its entries are stored as they are, as compressors differ from machine to machine. Whatever rvmon
would not have written so is refused, or told: nothing can hide beside what the archive shows.
"""

from __future__ import annotations

import hashlib
import io
import zipfile
from collections.abc import Mapping
from pathlib import Path

from rvmon.errors import RvmonError

SUMS = "SHA256SUMS"
"""The entry with a line for each of the others, as `sha256sum --check` reads it."""

MOST_BYTES = 1 << 30

MOST_ENTRIES = 65_000
"""More need another form of index."""

_MOST_INDEX = 1 << 24
"""Bytes of the index."""

_INDEX_END, _OTHER_INDEX = 22, 20
"""Bytes behind the index: the last of a zip file without a comment. Before them stand those of the
other form, where it has that."""

_STAMP = (1980, 1, 1, 0, 0, 0)
_UNIX, _RIGHTS = 3, 0o100644 << 16


class TamperedError(RvmonError):
    """An archive does not hold what was written."""


def pack(entries: Mapping[str, bytes]) -> bytes:
    """The archive of these entries, and of their checksums.

    Raises:
        RvmonError: it would be too large to be read again.

    >>> pack({"b": b"1", "a": b"2"}) == pack({"a": b"2", "b": b"1"})
    True
    """
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as packed:
        for name, body in sorted({**entries, SUMS: _sums(entries)}.items()):
            entry = zipfile.ZipInfo(name, _STAMP)
            entry.create_system, entry.external_attr = _UNIX, _RIGHTS
            packed.writestr(entry, body)
        index_at = packed.start_dir
    index = made.tell() - index_at
    if made.tell() > MOST_BYTES or index > _MOST_INDEX or len(entries) > MOST_ENTRIES:
        raise RvmonError(f"{len(entries):,} entries, {made.tell():,} bytes: too much for evidence")
    return made.getvalue()


def unpack(path: str) -> dict[str, bytes]:
    """The entries of an archive without their checksums.

    Raises:
        RvmonError: it cannot be read, or is nothing that `pack` writes.
        TamperedError: it was changed since.
    """
    try:
        if not Path(path).is_file():
            raise RvmonError(f"{path}: there is no such file")
        if Path(path).stat().st_size > MOST_BYTES:
            raise RvmonError(f"{path} is larger than {MOST_BYTES >> 30} GB, and is no evidence")
        data = Path(path).read_bytes()
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror or error}") from None
    entries = _entries(path, data)
    sums = entries.pop(SUMS, b"")
    _expect_sums(path, entries, sums)
    if pack(entries) != data:
        raise TamperedError(f"{path} holds more than its entries, or holds them otherwise")
    return entries


def _entries(path: str, data: bytes) -> dict[str, bytes]:
    entries: dict[str, bytes] = {}
    end = data[-_INDEX_END:]
    before = data[-_INDEX_END - _OTHER_INDEX : -_INDEX_END]
    is_bounded = int.from_bytes(end[12:16], "little") <= _MOST_INDEX
    if not end.startswith(b"PK\5\6") or before.startswith(b"PK\6\7") or not is_bounded:
        raise RvmonError(f"{path} is no evidence, or a damaged one: its end is not that of one")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as packed:
            left = len(data)
            for entry in packed.infolist():
                left -= entry.file_size
                if entry.compress_type != zipfile.ZIP_STORED or entry.flag_bits & 1 or left < 0:
                    raise RvmonError(f"{path} is no evidence: its entries are packed or overlap")
                if entry.filename in entries:
                    raise RvmonError(f"{path} is no evidence: it has two `{entry.filename}`")
                entries[entry.filename] = packed.read(entry)
    except (zipfile.BadZipFile, EOFError, ValueError, NotImplementedError, OSError) as error:
        raise TamperedError(f"{path} is damaged: {error}") from None
    return entries


def _sums(entries: Mapping[str, bytes]) -> bytes:
    lines = (f"{hashlib.sha256(body).hexdigest()}  {name}\n" for name, body in entries.items())
    return "".join(sorted(lines, key=lambda line: line[66:])).encode()


def _expect_sums(path: str, entries: Mapping[str, bytes], sums: bytes) -> None:
    """See that the checksums are those of the entries.

    Raises:
        TamperedError: they are not; named are the entries.
    """
    said = set(sums.decode("utf-8", "replace").splitlines())
    have = _sums(entries).decode().splitlines()
    other = {line[66:] for line in said.symmetric_difference(have)}
    if other:
        names = ", ".join(sorted(other))
        raise TamperedError(f"{path}: {SUMS} says otherwise of {names}: changed, added or removed")
