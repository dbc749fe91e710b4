"""Files of lines in pieces of a bounded size."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import BinaryIO, TextIO

from rvmon.errors import TraceError

BLOCK = 1 << 20
"""Bytes of a piece."""


LONGEST_LINE = 1 << 26
"""Characters of a line; longer ones are refused."""


def bounded_lines(text: TextIO) -> Iterator[str]:
    """The lines of a text, which never fill the memory.

    Raises:
        TraceError: a line is too long.
    """
    for number, line in enumerate(iter(partial(text.readline, LONGEST_LINE + 1), ""), 1):
        if len(line) > LONGEST_LINE:
            raise TraceError(
                f"line {number}: longer than {LONGEST_LINE:,} characters: is this a recording? "
                "Put each sample on a line of its own"
            )
        yield line


def whole_pieces(file: BinaryIO, size: int) -> Iterator[bytes]:
    r"""A file in pieces of whole lines; the last line may lack its end.

    What follows a line that is too long is not read: who reads the line refuses it.
    """
    parts: list[bytes] = []
    length = 0
    while length <= LONGEST_LINE and (piece := file.read(size)):
        whole, newline, tail = piece.rpartition(b"\n")
        if newline:
            yield b"".join([*parts, whole, newline])
            parts, length = [], 0
        parts.append(tail)
        length += len(tail)
    if length:
        yield b"".join(parts)


def is_short_of_memory() -> bool:
    """Whether addresses are limited (`--max-memory`): Arrow reserves many more than it uses.

    A thread of it that gets none may end the process.
    """
    try:
        import resource
    except ImportError:
        return False
    return resource.getrlimit(resource.RLIMIT_AS)[0] != resource.RLIM_INFINITY
