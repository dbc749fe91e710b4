"""An archive whose bytes follow from what it holds: a zip file, sorted, without stamps of time.

Its entries are stored as they are: compressors differ from machine to machine.
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


class TamperedError(RvmonError):
    """Evidence is not what was written."""


def pack(entries: Mapping[str, bytes]) -> bytes:
    """The archive of these entries, and of their checksums.

    Raises:
        RvmonError: it would be too large to be read again.

    >>> pack({"b": b"1", "a": b"2"}) == pack({"a": b"2", "b": b"1"})
    True
    """
    sums = "".join(_sum(name, body) for name, body in sorted(entries.items()))
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as packed:
        for name, body in sorted({**entries, SUMS: sums.encode()}.items()):
            entry = zipfile.ZipInfo(name)
            entry.create_system, entry.external_attr = (
                3,
                0o100644 << 16,
            )  # as of Unix, whatever it is
            packed.writestr(entry, body)
    if made.tell() > MOST_BYTES:
        raise RvmonError(f"evidence of {made.tell():,} bytes is too much: evaluate fewer at once")
    return made.getvalue()


def _sum(name: str, body: bytes) -> str:
    return f"{hashlib.sha256(body).hexdigest()}  {name}\n"


def unpack(path: str) -> dict[str, bytes]:
    """The entries of an archive without their checksums.

    Raises:
        RvmonError: it cannot be read, or is nothing that `pack` writes.
        TamperedError: it was changed since, or is no archive.
    """
    try:
        if not Path(path).is_file() or Path(path).stat().st_size > MOST_BYTES:
            raise RvmonError(f"{path} is no file, or larger than {MOST_BYTES >> 30} GB")
        data = Path(path).read_bytes()
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror or error}") from None
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as packed:
            found = packed.infolist()
            # What is stored as it is, and once, is no larger than the file: nothing unfolds.
            is_packed = any(entry.compress_type != zipfile.ZIP_STORED for entry in found)
            is_doubled = len({entry.filename for entry in found}) < len(found)
            if is_packed or is_doubled or sum(entry.file_size for entry in found) > len(data):
                raise RvmonError(f"{path} is no evidence: entries are packed, doubled or overlap")
            entries = {entry.filename: packed.read(entry) for entry in found}
    except (zipfile.BadZipFile, EOFError, ValueError, NotImplementedError, RuntimeError) as error:
        raise TamperedError(f"{path} is no evidence, or a damaged one: {error}") from None
    sums = entries.pop(SUMS, b"").decode("utf-8", "replace")
    if pack(entries) != data:
        other = [name for name, body in entries.items() if _sum(name, body) not in sums]
        names = ", ".join(other) or "its form, or what it lacks"
        raise TamperedError(f"{path} was changed since it was written: {names}")
    return entries
