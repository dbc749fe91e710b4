"""Texts that people wrote, read from files: these are regular files of a bounded size."""

from __future__ import annotations

import errno
import os
import stat
import sys
from pathlib import Path

MEGABYTE = 1 << 20

MOST = 10
"""Megabytes of a text, unless `RVMON_MAX_TEXT` says otherwise."""


def text_of_file(path: str | Path, encoding: str = "utf-8") -> str:
    """Read a specification or a model.

    Args:
        path: of a regular file.
        encoding: how its characters are written.

    Raises:
        OSError: it cannot be read, is a device or a pipe, or is too large; `strerror` says which.
        UnicodeDecodeError: it is not text.
    """
    with open(path, "rb", opener=_open_at_once) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise OSError(errno.EINVAL, "a device or a pipe: a regular file is expected")
        data = file.read(_most() + 1)
    _refuse_large(len(data))
    return data.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")


def text_of_input() -> str:
    """Read a specification from standard input; see `text_of_file`."""
    text = sys.stdin.read(_most() + 1)
    _refuse_large(len(text))
    return text


def _open_at_once(path: str, flags: int) -> int:
    """Open without waiting for the other end of a pipe."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def _most() -> int:
    given = os.environ.get("RVMON_MAX_TEXT", "")
    return (int(given) if given.isascii() and given.isdigit() else MOST) * MEGABYTE


def _refuse_large(size: int) -> None:
    most = _most()
    if size > most:
        reason = f"larger than {most // MEGABYTE} MB: if that is meant, set RVMON_MAX_TEXT (in MB)"
        raise OSError(errno.EFBIG, reason)
