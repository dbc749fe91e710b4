"""The folder, or file, that output goes to."""

from __future__ import annotations

from pathlib import Path

from rvmon.errors import RvmonError, writing
from rvmon.files import write_whole


def made(folder: str | Path) -> Path:
    """Make a folder if it does not exist, and see that files can be written there.

    Raises:
        RvmonError: that is not possible; the message says why.
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
    """Say, before any work is done for it, that a file cannot be written.

    Raises:
        RvmonError: it is a folder, or has none.
    """
    path = Path(path)
    if path.is_dir():
        raise RvmonError(f"cannot write {path}: it is a folder: name a file")
    if not path.parent.is_dir():
        raise RvmonError(f"cannot write {path}: there is no folder {path.parent}")


def write_file(path: str | Path, text: str) -> None:
    """Write a file that a person named.

    Raises:
        RvmonError: it cannot be written; the message says why.
    """
    with writing(path):
        write_whole(path, text)
