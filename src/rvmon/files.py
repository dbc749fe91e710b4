"""Atomic writing of files, output folders, and the user's cache.

A file is written completely or not at all, whatever ends the process.

The cache holds only data that can be computed again, and nothing in it is executed. Even so, a
folder or file that another user can write is ignored, and so is a file that does not match its
checksum. A broken cache never stops rvmon. It can be deleted at any time, and several processes can
use it at once. `RVMON_CACHE=off` switches it off; `RVMON_CACHE_MB` limits its size.
"""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from operator import attrgetter
from pathlib import Path

from rvmon.errors import RvmonError, writing

PREFIX, SUFFIX = ".rvmon-", ".part"
"""Prefix and suffix of the names of unfinished files."""

_IN_PLACE = (errno.EPERM, errno.EACCES, errno.EBUSY)
"""Errors after which a file that cannot be replaced is written in place; not so a full disk."""


def write_whole(path: str | Path, body: str | bytes) -> None:
    r"""Write a file for a user; the old file stays until the new one is complete.

    A file that cannot be replaced without loss is written in place instead: a pipe or terminal, a
    file with several hard links or another owner, or one in a folder that takes no new files.

    Args:
        path: of the file; a symbolic link is followed and stays a link.
        body: the contents; text is written as UTF-8.

    Raises:
        OSError: the file cannot be written.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     write_whole(f"{folder}/a.txt", "é")
    ...     Path(folder, "a.txt").read_bytes(), os.listdir(folder)
    (b'\xc3\xa9', ['a.txt'])
    """
    body = body.encode("utf-8") if isinstance(body, str) else body
    target = Path(os.path.realpath(path))
    try:
        place_whole(target, body, mode=_mode_if_replaceable(target))
    except OSError as error:
        if error.errno not in _IN_PLACE:
            raise
        target.write_bytes(body)


def _mode_if_replaceable(path: Path) -> int | None:
    """The permissions of a file that can be replaced without loss.

    Returns:
        The mode, or `None` if there is no file.

    Raises:
        OSError: the file must be written in place.
    """
    try:
        found = path.stat()
    except FileNotFoundError:
        return None
    plain = stat.S_ISREG(found.st_mode) and found.st_nlink == 1 and os.access(path, os.W_OK)
    if not plain or (hasattr(os, "geteuid") and found.st_uid != os.geteuid()):
        raise PermissionError(errno.EPERM, "cannot be replaced", str(path))
    return stat.S_IMODE(found.st_mode)


def place_whole(path: Path, body: bytes, *, mode: int | None = None) -> None:
    """Write a temporary file in the same folder, then move it to the path.

    Args:
        path: of the file; a symbolic link there is replaced.
        body: its contents.
        mode: its permissions; default: those of new files.

    Raises:
        OSError: the file cannot be written; nothing has changed.
    """
    temporary = path.parent / f"{PREFIX}{os.urandom(4).hex()}{SUFFIX}"
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
    handle = os.open(temporary, flags, 0o666 if mode is None else mode)
    try:
        with open(handle, "wb") as file:
            if mode is not None and hasattr(os, "fchmod"):
                os.fchmod(handle, mode)  # `os.open` has applied the umask to it
            file.write(body)
        os.replace(temporary, path)
    except BaseException:
        with suppress(OSError):
            temporary.unlink()
        raise


@contextmanager
def staged(path: str | Path) -> Iterator[Path]:
    """A temporary path for a file or folder; it is moved to `path` when the block ends normally.

    Args:
        path: of the file, which is replaced if it exists, or of a new folder.

    Raises:
        OSError: the result cannot be moved there; what was there stays.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     with staged(f"{folder}/a.txt") as place:
    ...         _ = place.write_text("a")
    ...     os.listdir(folder)
    ['a.txt']
    """
    from tempfile import TemporaryDirectory  # slow to import

    final = Path(os.path.realpath(path))
    with TemporaryDirectory(prefix=PREFIX, dir=final.parent) as folder:
        place = Path(folder, final.name)
        yield place
        place.replace(final)


_MOST_MB = 256
"""Default limit of the cache in megabytes."""

_IN_USE_S = 60.0
"""A file used within so many seconds is not deleted: a process may be about to read it."""

_ABANDONED_S = 3_600.0
"""An unfinished file of this age in seconds was left by a process that was killed."""

_TIDY_S = 60.0
"""Least seconds between two scans of the folder, which are slow if it holds thousands of files."""

_TIDIED = "tidied"
"""The file whose modification time is that of the last scan."""

_NAMES = rf"(?P<unfinished>{PREFIX}\w{{8}}{SUFFIX})|(\w+-)?[0-9a-f]{{40,}}[-.].+"
"""The names of the files that rvmon puts in the cache; any others are never deleted."""


def cache_folder() -> Path | None:
    """The folder of the cache; `None` if it is switched off or others could write there.

    Source: XDG Base Directory Specification: relative paths are ignored.
    """
    if os.environ.get("RVMON_CACHE", "").lower() in ("off", "0", "no"):
        return None
    base = os.environ.get("XDG_CACHE_HOME", "")
    try:
        folder = (Path(base) if os.path.isabs(base) else Path.home() / ".cache") / "rvmon"
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        return folder if is_ours(folder) else None
    except (OSError, RuntimeError):  # it cannot be created, or the user has no home
        return None


def is_ours(path: Path) -> bool:
    """Whether a path is a file or folder that only this user can change, where the OS can tell.

    Raises:
        OSError: nothing exists at the path.
    """
    status = path.stat()
    if not (stat.S_ISREG(status.st_mode) or stat.S_ISDIR(status.st_mode)):
        return False
    if not hasattr(os, "getuid"):
        return True
    owners = {status.st_uid, path.lstat().st_uid}  # of the file, and of a link to it
    return owners == {os.getuid()} and not status.st_mode & 0o022


@cache
def this_rvmon() -> str:
    """Identifier of this version of rvmon: a checksum of its files' paths, sizes and times."""
    files = ((entry.path, entry.stat()) for entry in files_within(os.path.dirname(__file__)))
    stamps = [(path, found.st_size, found.st_mtime_ns) for path, found in files]
    return _checksum(repr(stamps).encode())


def contents(path: Path) -> Iterator[tuple[str, str]]:
    """The files of a folder of sources, or one file, each as relative path and checksum.

    The result does not depend on the machine, the place or the time of the installation.
    """
    if path.is_dir():
        for entry in files_within(str(path)):
            yield os.path.relpath(entry.path, path), _checksum(Path(entry).read_bytes())
    else:
        yield path.name, _checksum(path.read_bytes())


def files_within(folder: str) -> Iterator[os.DirEntry[str]]:
    """The files of a folder of sources and of all its subfolders but `__pycache__`."""
    folders = [folder]
    for one in folders:  # grows during the loop
        with os.scandir(one) as entries:
            for entry in sorted(entries, key=attrgetter("name")):
                if not entry.is_dir():
                    yield entry
                elif entry.name != "__pycache__":
                    folders.append(entry.path)


def read_kept(path: Path) -> bytes | None:
    """The cached bytes; `None` if there are none, others can write them, or they are damaged."""
    try:
        if not is_ours(path):
            return None
        checksum, _, body = path.read_bytes().partition(b"\n")
        os.utime(path)  # marks the file as used, see `_tidy`
    except OSError:
        return None
    return body if _checksum(body).encode() == checksum else None


def keep(path: Path, body: bytes) -> None:
    """Write a file of the cache atomically; errors are ignored."""
    with suppress(OSError):
        whole = f"{_checksum(body)}\n".encode() + body
        place_whole(path, whole, mode=0o600)  # no fsync: the checksum reveals a truncated file
        _tidy(path.parent)


def _checksum(body: bytes) -> str:
    return hashlib.sha256(body).hexdigest()


def _tidy(folder: Path) -> None:
    """Delete files left by killed processes; above the limit, also those unused for longest.

    It then deletes down to half the limit, so that the next files do not cause a deletion each.
    """
    import re
    import time

    now = time.time()
    with suppress(FileNotFoundError):
        if now - (folder / _TIDIED).stat().st_mtime < _TIDY_S:
            return
    (folder / _TIDIED).touch(mode=0o600)
    entries: list[tuple[float, int, str]] = []
    for entry in os.scandir(folder):
        named = re.fullmatch(_NAMES, entry.name)
        if named is None:
            continue
        with suppress(FileNotFoundError):  # another process may be tidying as well
            about = entry.stat(follow_symlinks=False)
            if not named["unfinished"]:
                entries.append((about.st_mtime, about.st_size, entry.path))
            elif now - about.st_mtime > _ABANDONED_S:
                os.unlink(entry.path)
    most = _most()
    size = sum(bytes_ for _, bytes_, _ in entries)
    if size <= most:
        return
    for used, bytes_, path in sorted(entries):
        if size <= most // 2 or now - used < _IN_USE_S:
            break
        Path(path).unlink(missing_ok=True)
        size -= bytes_


def _most() -> int:
    """Limit of the cache in bytes; `RVMON_CACHE_MB` is ignored if it is not a number."""
    limit = os.environ.get("RVMON_CACHE_MB", "")
    return 1_000_000 * int(limit if limit.isascii() and limit.isdecimal() else _MOST_MB)


def output_folder(folder: str | Path) -> Path:
    """Create a folder if it does not exist, and check that files can be written there.

    Raises:
        RvmonError: it cannot be created or written; the message says why.
    """
    path = Path(folder)
    if path.exists() and not path.is_dir():
        raise RvmonError(f"error: cannot write to {path}: it is a file: name a folder")
    probe = path / ".rvmon-writes-here"
    try:
        path.mkdir(parents=True, exist_ok=True)
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise RvmonError(f"error: cannot write to {path}: {error.strerror}") from None
    return path


def refuse_no_file(path: str | Path) -> None:
    """Refuse an impossible output path before the work for its contents starts.

    Raises:
        RvmonError: the path is a folder, or its folder does not exist.
    """
    path = Path(path)
    if path.is_dir():
        raise RvmonError(f"cannot write {path}: it is a folder: name a file")
    if not path.parent.is_dir():
        raise RvmonError(f"cannot write {path}: there is no folder {path.parent}")


def write_file(path: str | Path, text: str) -> None:
    """Write a file that the user named.

    Raises:
        RvmonError: the file cannot be written; the message says why.
    """
    with writing(path):
        write_whole(path, text)
