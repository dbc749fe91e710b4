"""Files that others see whole or not at all, whatever ends the process that writes them."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

PREFIX, SUFFIX = ".rvmon-", ".part"
"""Of names that stand for what is not finished."""

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


def place_whole(path: Path, body: bytes, *, mode: int | None = None, synced: bool = False) -> None:
    """Write a file beside its place, then put it there; a link that is there goes.

    Args:
        path: of the file.
        body: what it holds.
        mode: its rights; default: those that new files have.
        synced: whether it is on the disk before it is seen, and still there after a loss of power.

    Raises:
        OSError: it cannot be written; nothing has changed.
    """
    beside = path.parent / f"{PREFIX}{os.urandom(4).hex()}{SUFFIX}"
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
    handle = os.open(beside, flags, 0o666 if mode is None else mode)
    try:
        with open(handle, "wb") as file:
            if mode is not None and hasattr(os, "fchmod"):
                os.fchmod(handle, mode)  # whatever the umask says
            file.write(body)
            file.flush()
            if synced:
                os.fsync(handle)
        os.replace(beside, path)
    except BaseException:
        with suppress(OSError):
            beside.unlink()
        raise
    if synced and hasattr(os, "O_DIRECTORY"):
        folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


@contextmanager
def beside(path: str | Path) -> Iterator[Path]:
    """A place of the same name for a file or folder, which is put at the path when it is whole.

    Args:
        path: of the file, which is replaced if it is there, or of a new folder.

    Raises:
        OSError: it cannot be put there; what was there stays.

    >>> with TemporaryDirectory() as folder:
    ...     with beside(f"{folder}/a.txt") as place:
    ...         _ = place.write_text("a")
    ...     os.listdir(folder)
    ['a.txt']
    """
    final = Path(os.path.realpath(path))
    with TemporaryDirectory(prefix=PREFIX, dir=final.parent) as folder:
        place = Path(folder, final.name)
        yield place
        place.replace(final)
