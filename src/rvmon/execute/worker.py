"""The worker side of `parallel.execute`: a process that does tasks for its parent."""

from __future__ import annotations

import gc
import os
import pickle
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, MutableSequence
from contextlib import suppress
from multiprocessing.connection import Connection
from queue import SimpleQueue
from typing import Any

from rvmon.errors import RvmonError

CHUNK_S = 0.1
"""Seconds after which a worker answers; the rest of its chunk may then go to another worker."""

_PR_SET_PDEATHSIG = 1


def serve(
    connection: Connection,
    other: Connection,
    prepare: Callable[[], Callable[[Any], Any]],
    parent: int | None,
    started: MutableSequence[float],
) -> None:
    """Do the tasks that arrive, until the parent closes the connection.

    Each message is a chunk: a list of pickled tasks. Its answer is a list with, for each task done
    within `CHUNK_S` up to the first that failed, whether it failed and its pickled result or error.
    With one message per task, the parent would wake up, and interrupt this process, hundreds of
    times a second.

    Args:
        connection: to the parent.
        other: the parent's end of the connection, which is closed here.
        prepare: called before the first task; returns the function that does a task.
        parent: id of the process whose death kills this one on Linux; `None`: no process.
        started: shared memory that the parent reads if this process is lost: the number of tasks
            started in all, and the time of the last start on the monotonic clock.
    """
    other.close()
    gc.freeze()  # otherwise the collector would write to inherited objects and copy their pages
    _leave_signals(parent)
    chunks: SimpleQueue[list[bytes]] = SimpleQueue()
    threading.Thread(target=_receive, args=(connection, chunks), daemon=True).start()
    work: Callable[[Any], Any] | None = None

    def next_task() -> Callable[[Any], Any]:
        nonlocal work
        if work is None:
            work = prepare()
        started[1] = time.monotonic()
        started[0] += 1
        return work

    with suppress(OSError):  # the parent has closed the connection
        while True:
            answers = []
            end = time.monotonic() + CHUNK_S
            for task in chunks.get():
                answers.append(answer(next_task, task))
                has_failed, _ = answers[-1]
                if has_failed or time.monotonic() >= end:
                    break
            connection.send(answers)


def answer(work: Callable[[], Callable[[Any], Any]], task: bytes) -> tuple[bool, bytes]:
    """Do a pickled task with the function that `work` returns.

    Returns:
        Whether it failed, and its result or error, pickled.
    """
    try:
        return False, pickle.dumps(work()(pickle.loads(task)))  # noqa: S301 - from the parent
    except Exception as error:  # noqa: BLE001 - raised in the parent
        return True, packed_error(error)


def _leave_signals(parent: int | None) -> None:
    """Ignore Ctrl-C, which the parent handles; end by SIGTERM and, on Linux, with the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT, signal.SIGTERM))
    if parent is not None and sys.platform == "linux":
        import ctypes

        # `_receive` notices a closed connection, but not while C code holds the GIL for long; a
        # signal always works.
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        if os.getppid() != parent:  # the parent died before the call
            os._exit(1)


def _receive(connection: Connection, chunks: SimpleQueue[list[bytes]]) -> None:
    """Receive chunks in a thread; exit at once when the parent closes the connection."""
    try:
        while True:
            chunks.put(connection.recv())
    except (EOFError, OSError):
        os._exit(1)


def packed_error(error: Exception) -> bytes:
    """A pickle of an error that another process can load; an unexpected one notes its traceback."""
    if not isinstance(error, RvmonError):
        error.add_note(traceback.format_exc())
    try:
        packed = pickle.dumps(error)
        pickle.loads(packed)  # noqa: S301 - just made
    except Exception:  # noqa: BLE001 - pickling a foreign exception may raise anything
        name = "" if isinstance(error, RvmonError) else f"{type(error).__name__}: "
        return pickle.dumps(RvmonError(f"{name}{error}"))
    return packed
