"""The folder that output goes to."""

from __future__ import annotations

from pathlib import Path

from rvmon.errors import RvmonError


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
