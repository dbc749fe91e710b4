"""The user's cache folder: data that can be worked out again, whole or not at all.

It holds specifications as data, and with the engine `c` what a C compiler made of our source, which
is run: so a folder that anyone else can write to is passed over. Whatever is wrong with it, it can
be done without; it can be deleted at any time, and used by several processes at once.
`RVMON_CACHE=off` switches it off.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

_MOST = 256
"""So many files of one kind are kept: those used last."""


def cache_folder() -> Path | None:
    """Where files are kept; `None` if nowhere: switched off, or others could write there."""
    if os.environ.get("RVMON_CACHE", "").lower() in ("off", "0", "no"):
        return None
    try:
        folder = made_folder()
        return folder if is_ours(folder) else None
    except (OSError, RuntimeError):
        return None


def made_folder() -> Path:
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
    """Whether nobody else can write there, as far as the system can tell."""
    if not hasattr(os, "getuid"):
        return True
    found = path.stat()
    return found.st_uid == os.getuid() and not found.st_mode & 0o022


def files_told(folder: str) -> Iterator[tuple[str, int, int]]:
    """What tells the files of a folder of sources from others: path, bytes and time of change."""
    folders = [folder]
    for one in folders:  # grows
        with os.scandir(one) as entries:
            for entry in sorted(entries, key=lambda entry: entry.name):
                if entry.is_dir():
                    folders += [entry.path] if entry.name != "__pycache__" else []
                else:
                    found = entry.stat()
                    yield entry.path, found.st_size, found.st_mtime_ns


def read_kept(path: Path) -> bytes | None:
    """What was written there; `None` if that is nothing, not ours, or not whole."""
    try:
        if not is_ours(path):
            return None
        checksum, _, body = path.read_bytes().partition(b"\n")
        os.utime(path)
    except OSError:
        return None
    return body if hashlib.sha256(body).hexdigest().encode() == checksum else None


def keep(path: Path, body: bytes) -> None:
    """Write a file so that others see it whole or not at all; if that fails, never mind."""
    import tempfile

    name = ""
    with suppress(OSError):
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            name = file.name
            file.write(hashlib.sha256(body).hexdigest().encode() + b"\n" + body)
        Path(name).replace(path)
        _prune(path)
        return
    if name:
        Path(name).unlink(missing_ok=True)


def _prune(path: Path) -> None:
    """Delete the files of its kind that were not used for longest, when there are too many."""
    kind = path.name.partition("-")[0]
    found = list(path.parent.glob(f"{kind}-*{path.suffix}"))
    if len(found) > _MOST:
        found.sort(key=lambda one: one.stat().st_mtime)
        for one in found[: len(found) - _MOST // 2]:
            one.unlink(missing_ok=True)
