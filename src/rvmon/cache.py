"""The user's cache folder: data that can be worked out again, whole or not at all.

It holds data alone, and nothing of it is run; all the same a folder or a file that anyone else can
write to is passed over, and so is what differs from its checksum. Whatever is wrong with it, it can
be done without; it can be deleted at any time, and used by several processes at once.
`RVMON_CACHE=off` switches it off; `RVMON_CACHE_MB` says how large it may become.
"""

from __future__ import annotations

import hashlib
import os
import stat
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from rvmon.writing import PREFIX, SUFFIX, place_whole

_MOST_MB = 256
"""Megabytes that are kept, if nothing else is set."""

_IN_USE_S = 60.0
"""Seconds in which a file that was used is not deleted: a process may be about to read it."""

_ABANDONED_S = 3_600.0
"""Seconds after which nobody writes any more what is not finished."""

_TIDY_S = 60.0
"""Seconds between two looks through the folder, which take their time if it holds thousands."""

_TIDIED = "tidied"
"""The file whose time of change says when the last look was."""

_NAMES = rf"(?P<unfinished>{PREFIX}\w{{8}}{SUFFIX})|(\w+-)?[0-9a-f]{{40,}}[-.].+"
"""The names of all that rvmon puts there; a folder may by mistake hold other things."""


def cache_folder() -> Path | None:
    """Where files are kept; `None` if nowhere: switched off, or others could write there."""
    if os.environ.get("RVMON_CACHE", "").lower() in ("off", "0", "no"):
        return None
    try:
        folder = _made_folder()
        return folder if is_ours(folder) else None
    except (OSError, RuntimeError):
        return None


def _made_folder() -> Path:
    """The user's cache folder of rvmon, made if need be.

    Raises:
        OSError: it cannot be made.
        RuntimeError: the user has no home.

    Source: XDG Base Directory Specification: paths that are not absolute are passed over.
    """
    base = os.environ.get("XDG_CACHE_HOME", "")
    folder = (Path(base) if os.path.isabs(base) else Path.home() / ".cache") / "rvmon"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    return folder


def is_ours(path: Path) -> bool:
    """Whether it is a file or folder that nobody else can change, as far as the system shows.

    Raises:
        OSError: there is none.
    """
    found = path.stat()
    if not (stat.S_ISREG(found.st_mode) or stat.S_ISDIR(found.st_mode)):
        return False
    if not hasattr(os, "getuid"):
        return True
    owners = {found.st_uid, path.lstat().st_uid}  # of the file, and of a link to it
    return owners == {os.getuid()} and not found.st_mode & 0o022


def file_stamps(folder: str) -> Iterator[tuple[str, int, int]]:
    """What distinguishes the files of a folder of sources: path, bytes and time of change."""
    for entry in _files(folder):
        found = entry.stat()
        yield entry.path, found.st_size, found.st_mtime_ns


def contents(path: Path) -> Iterator[tuple[str, str]]:
    """What a file, or a folder of sources, holds: each path within, and a checksum.

    It is the same on every machine, wherever it is and whenever it was installed.
    """
    if path.is_dir():
        for entry in _files(str(path)):
            yield os.path.relpath(entry.path, path), _checksum(Path(entry).read_bytes())
    else:
        yield path.name, _checksum(path.read_bytes())


def _files(folder: str) -> Iterator[os.DirEntry[str]]:
    folders = [folder]
    for one in folders:  # grows
        with os.scandir(one) as entries:
            for entry in sorted(entries, key=lambda entry: entry.name):
                if not entry.is_dir():
                    yield entry
                elif entry.name != "__pycache__":
                    folders.append(entry.path)


def read_kept(path: Path) -> bytes | None:
    """What was written there; `None` if that is nothing, not ours, or not whole."""
    checksum, _, body = (_read(path) or b"").partition(b"\n")
    return body if _checksum(body).encode() == checksum else None


def keep(path: Path, body: bytes) -> None:
    """Write a file so that others see it whole or not at all; if that fails, never mind."""
    with suppress(OSError):
        whole = f"{_checksum(body)}\n".encode() + body
        place_whole(path, whole, mode=0o600, synced=True)
        _tidy(path.parent)


def _checksum(body: bytes) -> str:
    return hashlib.sha256(body).hexdigest()


def _read(path: Path) -> bytes | None:
    """The bytes of a file of ours, which is used now; `None` if there is none."""
    try:
        if not is_ours(path):
            return None
        body = path.read_bytes()
        os.utime(path)
    except OSError:
        return None
    return body


def _tidy(folder: Path) -> None:
    """Delete what killed processes left, and of too much what was not used for longest."""
    import re
    import time

    now = time.time()
    with suppress(FileNotFoundError):
        if now - (folder / _TIDIED).stat().st_mtime < _TIDY_S:
            return
    (folder / _TIDIED).touch(mode=0o600)
    found: list[tuple[float, int, str]] = []
    for entry in os.scandir(folder):
        named = re.fullmatch(_NAMES, entry.name)
        if named is None:
            continue
        with suppress(FileNotFoundError):  # another process tidies as well
            about = entry.stat(follow_symlinks=False)
            if not named["unfinished"]:
                found.append((about.st_mtime, about.st_size, entry.path))
            elif now - about.st_mtime > _ABANDONED_S:
                os.unlink(entry.path)
    most = _most()
    size = sum(bytes_ for _, bytes_, _ in found)
    if size <= most:
        return
    for used, bytes_, path in sorted(found):
        if size <= most // 2 or now - used < _IN_USE_S:
            break
        Path(path).unlink(missing_ok=True)
        size -= bytes_


def _most() -> int:
    """Bytes that are kept; what `RVMON_CACHE_MB` says is passed over if it is no number."""
    limit = os.environ.get("RVMON_CACHE_MB", "")
    return 1_000_000 * int(limit if limit.isascii() and limit.isdecimal() else _MOST_MB)
