"""Files written whole or not at all, whatever ends the process; output folders; the user's cache.

The cache holds data alone that can be worked out again, and nothing of it is run; all the same a
folder or a file that anyone else can write to is passed over, and so is what differs from its
checksum. Whatever is wrong with it, it can be done without; it can be deleted at any time, and used
by several processes at once. `RVMON_CACHE=off` switches it off; `RVMON_CACHE_MB` says how large it
may become.
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
"""Causes for which a file that cannot be replaced may still be written; a full disk is none."""


def write_whole(path: str | Path, body: str | bytes) -> None:
    r"""Write a file for a user: until all is written, the file that was there stays.

    A file that cannot be replaced without a loss is written in place: a pipe or a terminal, one
    that has several names or another owner, one in a folder that takes no others.

    Args:
        path: of the file; a link stays one.
        body: text is written as UTF-8.

    Raises:
        OSError: it cannot be written.

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
    """The rights of a file that nothing is lost with if another takes its place.

    Returns:
        `None` if there is no file.

    Raises:
        OSError: it is to be written in place.
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
    """Write a file beside its place, then put it there; a link that is there goes.

    Args:
        path: of the file.
        body: its contents.
        mode: its rights; default: those that new files have.

    Raises:
        OSError: it cannot be written; nothing has changed.
    """
    temporary = path.parent / f"{PREFIX}{os.urandom(4).hex()}{SUFFIX}"
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
    handle = os.open(temporary, flags, 0o666 if mode is None else mode)
    try:
        with open(handle, "wb") as file:
            if mode is not None and hasattr(os, "fchmod"):
                os.fchmod(handle, mode)  # whatever the umask says
            file.write(body)
        os.replace(temporary, path)
    except BaseException:
        with suppress(OSError):
            temporary.unlink()
        raise


@contextmanager
def staged(path: str | Path) -> Iterator[Path]:
    """A temporary place for a file or folder, which is moved to the path once it is complete.

    Args:
        path: of the file, which is replaced if it is there, or of a new folder.

    Raises:
        OSError: it cannot be put there; what was there stays.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     with staged(f"{folder}/a.txt") as place:
    ...         _ = place.write_text("a")
    ...     os.listdir(folder)
    ['a.txt']
    """
    from tempfile import TemporaryDirectory  # which loads much

    final = Path(os.path.realpath(path))
    with TemporaryDirectory(prefix=PREFIX, dir=final.parent) as folder:
        place = Path(folder, final.name)
        yield place
        place.replace(final)


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
    """The folder of the cache; `None` if there is none: switched off, or others could write there.

    Source: XDG Base Directory Specification: paths that are not absolute are passed over.
    """
    if os.environ.get("RVMON_CACHE", "").lower() in ("off", "0", "no"):
        return None
    base = os.environ.get("XDG_CACHE_HOME", "")
    try:
        folder = (Path(base) if os.path.isabs(base) else Path.home() / ".cache") / "rvmon"
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        return folder if is_ours(folder) else None
    except (OSError, RuntimeError):  # it cannot be made, or the user has no home
        return None


def is_ours(path: Path) -> bool:
    """Whether it is a file or folder that nobody else can change, as far as the system shows.

    Raises:
        OSError: there is none.
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
    """Tells this version of rvmon from others: a checksum of its files' paths, sizes and times."""
    files = ((entry.path, entry.stat()) for entry in files_within(os.path.dirname(__file__)))
    stamps = [(path, found.st_size, found.st_mtime_ns) for path, found in files]
    return _checksum(repr(stamps).encode())


def contents(path: Path) -> Iterator[tuple[str, str]]:
    """The contents of a file, or of a folder of sources: each path within, and a checksum.

    It is the same on every machine, wherever it is and whenever it was installed.
    """
    if path.is_dir():
        for entry in files_within(str(path)):
            yield os.path.relpath(entry.path, path), _checksum(Path(entry).read_bytes())
    else:
        yield path.name, _checksum(path.read_bytes())


def files_within(folder: str) -> Iterator[os.DirEntry[str]]:
    """The files of a folder of sources, and of those in it."""
    folders = [folder]
    for one in folders:  # grows
        with os.scandir(one) as entries:
            for entry in sorted(entries, key=attrgetter("name")):
                if not entry.is_dir():
                    yield entry
                elif entry.name != "__pycache__":
                    folders.append(entry.path)


def read_kept(path: Path) -> bytes | None:
    """The cached bytes; `None` if there are none, or they are not ours, or not whole."""
    try:
        if not is_ours(path):
            return None
        checksum, _, body = path.read_bytes().partition(b"\n")
        os.utime(path)  # it is used now
    except OSError:
        return None
    return body if _checksum(body).encode() == checksum else None


def keep(path: Path, body: bytes) -> None:
    """Write a file so that others see it whole or not at all; if that fails, never mind."""
    with suppress(OSError):
        whole = f"{_checksum(body)}\n".encode() + body
        place_whole(path, whole, mode=0o600)  # not synced: the checksum tells what is not whole
        _tidy(path.parent)


def _checksum(body: bytes) -> str:
    return hashlib.sha256(body).hexdigest()


def _tidy(folder: Path) -> None:
    """Delete what killed processes left, and of too much what was not used for longest."""
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
        with suppress(FileNotFoundError):  # another process tidies as well
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
    """Bytes that are kept; what `RVMON_CACHE_MB` says is passed over if it is no number."""
    limit = os.environ.get("RVMON_CACHE_MB", "")
    return 1_000_000 * int(limit if limit.isascii() and limit.isdecimal() else _MOST_MB)


def output_folder(folder: str | Path) -> Path:
    """Make a folder if it does not exist, and check that files can be written there.

    Raises:
        RvmonError: it cannot be made or written; the message says why.
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
    """Refuse an output file early, before any work is done for it.

    Raises:
        RvmonError: it is a folder, or its folder does not exist.
    """
    path = Path(path)
    if path.is_dir():
        raise RvmonError(f"cannot write {path}: it is a folder: name a file")
    if not path.parent.is_dir():
        raise RvmonError(f"cannot write {path}: there is no folder {path.parent}")


def write_file(path: str | Path, text: str) -> None:
    """Write a file that the user named.

    Raises:
        RvmonError: it cannot be written; the message says why.
    """
    with writing(path):
        write_whole(path, text)
