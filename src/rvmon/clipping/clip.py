"""A piece of a recording as a recording of the same format."""

from __future__ import annotations

import os
from pathlib import Path

from rvmon.clipping.piece import Copied, Piece
from rvmon.errors import RvmonError, TraceError
from rvmon.readers.messages.forms import MESSAGE_FORMATS
from rvmon.readers.places import endings_of, local_path
from rvmon.readers.recording import FORMATS, format_of
from rvmon.trace.time import format_ticks
from rvmon.writing import beside


def refuse_place(path: str, out: str) -> None:
    """Say, before any work is done for it, that a piece of a recording cannot go to a place.

    Raises:
        RvmonError: it has the ending of another format, or is a folder that is there.
        TraceError: the recording has no known format.
    """
    form = format_of(path)
    if path == "-":
        raise RvmonError("standard input can be read once only: save the recording first")
    if form == "tables":
        raise RvmonError(f"{path}: of a folder of tables no piece is written: clip its files")
    if form == "ros2" and local_path(path).is_dir():
        if os.path.lexists(out):
            raise RvmonError(f"cannot write {out}: it is there, and a bag is a new folder")
        return
    ending = endings_of(out)[0]
    if FORMATS.get(ending) != form:
        fitting = " or ".join(one for one, other in FORMATS.items() if other == form)
        raise RvmonError(f"cannot write {out}: a piece of {path} ends in {fitting}")
    if form not in ("csv", "jsonl") and endings_of(out)[1]:
        raise RvmonError(f"cannot write {out}: only text is packed")


def clip(path: str, piece: Piece, out: str) -> Copied:
    """Write a piece of a recording, whole or not at all.

    Args:
        path: of the recording; its copy, where it is an address.
        piece: what is cut out.
        out: the new file, or folder of ROS 2; see `refuse_place`.

    Returns:
        What of it is in the piece.

    Raises:
        RvmonError: a package is not installed, or the piece cannot be written.
        TraceError: the recording cannot be read up to the end of the piece, or has nothing in it.
    """
    try:
        with beside(out) as made:
            try:
                copied = _written(path, piece, made)
            except TraceError as error:
                message = str(error)
                raise TraceError(message if path in message else f"{path}: {message}") from None
            if not copied.count:
                between = f"{format_ticks(piece.start)} and {format_ticks(piece.stop)}"
                raise TraceError(f"{path}: there is nothing between {between}")
    except OSError as error:
        raise RvmonError(f"cannot write {out}: {error.strerror or error}") from None
    return copied


def _written(path: str, piece: Piece, out: Path) -> Copied:
    form = format_of(path)
    if form in MESSAGE_FORMATS.values():
        from rvmon.clipping.messages import clip_messages

        return clip_messages(path, form, piece, out)
    if form == "parquet":
        from rvmon.clipping.parquet import clip_parquet

        return clip_parquet(local_path(path), piece, out)
    from rvmon.clipping.text import clip_text

    return clip_text(path, piece, out, is_csv=form == "csv")
