"""Output folders and files, with errors for the user if they cannot be written."""

from __future__ import annotations

from pathlib import Path

from rvmon.errors import RvmonError, writing
from rvmon.files import write_whole


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
