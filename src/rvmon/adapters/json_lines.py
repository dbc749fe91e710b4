"""Live data as JSON lines, from a pipe or another stream of bytes."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import suppress

from rvmon.adapters.json_objects import JsonObjects, decoded_object
from rvmon.errors import RvmonError, TraceError
from rvmon.readers.line_chunks import LONGEST_LINE

_PIECE = 1 << 16
"""Bytes that are asked for at once; what is there is given at once."""


def feed_lines(objects: JsonObjects, lines: Iterable[bytes], robot: str | None = None) -> None:
    """Offer what lines say, until there are no more, or the driver is closed.

    It is to be called in a thread of its own.

    Where lines have a time they wait while others are judged: a pipe that is faster than the
    monitors is read more slowly, and nothing is lost.

    Args:
        objects: get them.
        lines: each an object.
        robot: the field that names the robot of a line; `None`: there is one robot.
    """
    with suppress(RvmonError):  # it was closed, as when somebody ends it
        for number, line in enumerate(lines, 1):
            if not line.strip():
                continue
            name = "" if robot is None else None
            try:
                fields = decoded_object(line)
                if robot is not None:
                    name = _name_of_robot(fields, robot)
                objects.take(fields, name or "", wait=True)
            except TraceError as error:
                objects.lose(f"line {number}", error, name)


def _name_of_robot(fields: object, robot: str) -> str:
    name = fields.pop(robot, None) if isinstance(fields, dict) else None
    if not isinstance(name, str | int) or isinstance(name, bool):
        raise TraceError(f"there is no robot's name in `{robot}`")
    return str(name)


def read_lines(file: int) -> Iterator[bytes]:
    """The lines of a file, each as soon as it is there.

    Args:
        file: the descriptor of a pipe, a file or a terminal.
    """
    rest = b""
    while piece := os.read(file, _PIECE):
        *whole, rest = (rest + piece).split(b"\n")
        yield from whole
        if len(rest) > LONGEST_LINE:
            yield rest
            rest = b""
    if rest:
        yield rest
