"""The far side of `parallel.execute`: a process that does tasks for the one that began it."""

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
"""Seconds after which a worker asks for tasks anew: what is left of a chunk may go to another."""

_PR_SET_PDEATHSIG = 1


def serve(
    connection: Connection,
    other: Connection,
    begin: Callable[[], Callable[[Any], Any]],
    parent: int | None,
    begun: MutableSequence[float],
) -> None:
    """Do the tasks that come, until the other end of the connection is closed.

    What comes are lists of pickled tasks. A list goes back for each: of those tasks that were done
    in `CHUNK_S`, up to one that failed, whether each failed, and its pickled result or error. One
    message for each task would wake the other process, and interrupt this one, hundreds of times a
    second.

    Args:
        connection: to who gives out the tasks.
        other: its other end, which only that process is to hold.
        begin: makes, before the first task, what does them.
        parent: the process whose death Linux is to report; `None`: nobody's.
        begun: for the other process to read if this one is lost: how many tasks were begun in all,
            and when the last, on the monotonic clock.
    """
    other.close()
    gc.freeze()  # what a fork has of its parent is not looked through, and so not copied
    _leave_signals(parent)
    chunks: SimpleQueue[list[bytes]] = SimpleQueue()
    threading.Thread(target=_receive, args=(connection, chunks), daemon=True).start()
    work: Callable[[Any], Any] | None = None

    def next_task() -> Callable[[Any], Any]:
        nonlocal work
        if work is None:
            work = begin()
        begun[1] = time.monotonic()
        begun[0] += 1
        return work

    with suppress(OSError):  # nobody takes an answer any more
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
    """Do a task.

    Returns:
        Whether it failed, and its result or error, pickled.
    """
    try:
        return False, pickle.dumps(work()(pickle.loads(task)))  # noqa: S301 - from the parent
    except Exception as error:  # noqa: BLE001 - raised where the result is asked for
        return True, packed_error(error)


def _leave_signals(parent: int | None) -> None:
    """The parent is interrupted as well as this process, and decides; that it dies is heeded."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT, signal.SIGTERM))
    if parent is not None and sys.platform == "linux":
        import ctypes

        # A signal reaches also a worker that holds Python's lock for long.
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        if os.getppid() != parent:  # it died before
            os._exit(1)


def _receive(connection: Connection, chunks: SimpleQueue[list[bytes]]) -> None:
    """Take in what comes while this process works; it ends with whoever began it."""
    try:
        while True:
            chunks.put(connection.recv())
    except (EOFError, OSError):
        os._exit(1)


def packed_error(error: Exception) -> bytes:
    """An error that can be read elsewhere; what nobody expected says where it happened."""
    if not isinstance(error, RvmonError):
        error.add_note(traceback.format_exc())
    try:
        packed = pickle.dumps(error)
        pickle.loads(packed)  # noqa: S301 - just made
    except Exception:  # noqa: BLE001 - of whatever kind others' errors are
        name = "" if isinstance(error, RvmonError) else f"{type(error).__name__}: "
        return pickle.dumps(RvmonError(f"{name}{error}"))
    return packed
