"""A text in stretches of whole lines, of which the next ones are read while one is looked at."""

from __future__ import annotations

import os
from codecs import getincrementaldecoder
from collections import deque
from collections.abc import Callable, Generator, Iterator
from typing import TYPE_CHECKING, BinaryIO, TypeVar

from rvmon.recordings import places

if TYPE_CHECKING:
    from concurrent.futures import Future, ThreadPoolExecutor

_Read = TypeVar("_Read")

MOST_THREADS = 4
"""The most reading threads; the consumer of their results is slower than these."""


def stretches(first: bytes, file: BinaryIO) -> Iterator[bytes]:
    r"""A text in stretches that end with a line, but the last one; a line may be in several.

    Args:
        first: its first `places.BLOCK` bytes; where there are fewer, `file` is not read.
        file: gives what follows; each call as many bytes as are asked for, but at its end.

    Raises:
        UnicodeDecodeError: it is no text.

    >>> import io
    >>> list(stretches(b"t,p\n0,1\n1,", io.BytesIO()))
    [b't,p\n0,1\n1,']
    """
    decoder = getincrementaldecoder("utf-8")()
    tail, piece = b"", first
    while piece:
        # Most texts are ASCII, which needs no decoder; a character may be split between two blocks.
        if decoder.getstate()[0] or not piece.isascii():
            decoder.decode(piece)
        is_last = len(piece) < places.BLOCK
        if is_last and not decoder.getstate()[0]:
            yield tail + piece
            return
        whole = piece.rfind(b"\n") + 1 or len(piece)
        yield b"".join((tail, memoryview(piece)[:whole]))
        tail = piece[whole:]
        piece = b"" if is_last else file.read(places.BLOCK)
    decoder.decode(b"", final=True)
    yield tail


def read_ahead(
    found: Iterator[bytes], read: Callable[[bytes], _Read]
) -> Generator[tuple[bytes, Callable[[], _Read] | None], None, None]:
    """Stretches, each with what gives what another thread read in it; of one without end nothing.

    Args:
        found: are taken in order, some before they are asked for; so is what goes wrong then.
        read: may run in several threads at once.
    """
    pool: ThreadPoolExecutor | None = None
    threads = 0
    waiting: deque[tuple[bytes, Future[_Read] | None]] = deque()
    fault: Exception | None = None
    is_over = False
    try:
        while True:
            while not is_over and len(waiting) <= threads:
                try:
                    stretch = next(found, None)
                except Exception as error:  # noqa: BLE001 - raised in its turn
                    stretch, fault = None, error
                is_over = stretch is None
                if stretch is not None and stretch.endswith(b"\n"):
                    if pool is None:  # a small file has no such stretch
                        threads = min(MOST_THREADS, os.cpu_count() or 1)
                        pool = _begun(threads)
                    waiting.append((stretch, pool.submit(read, stretch)))
                elif stretch is not None:
                    waiting.append((stretch, None))
            if not waiting:
                break
            stretch, one = waiting.popleft()
            yield stretch, None if one is None else one.result
        if fault is not None:
            raise fault
    finally:
        del fault  # its traceback holds this frame
        for _, one in waiting:
            if one is not None:
                one.cancel()
        if pool is not None:
            pool.shutdown()


def _begun(threads: int) -> ThreadPoolExecutor:
    from concurrent.futures import ThreadPoolExecutor

    return ThreadPoolExecutor(threads, "rvmon-reads")
