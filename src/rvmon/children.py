"""Processes that are begun here and never outlive the one that began them.

Whoever dies closes its end of a pipe, on every system and however it dies; on the other end someone
waits. Linux also sends workers a signal, which reaches one that holds Python's lock for long.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rvmon.errors import WorkerLostError

if TYPE_CHECKING:
    import subprocess
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing.connection import Connection

_WATCHED = """
exec 3<&0
"$@" </dev/null 3<&- &
job=$!
{ read _; kill -9 0; } <&3 >/dev/null 2>&1 &
exec 3<&-
wait $job
code=$?
kill -9 $!
exit $code
"""
"""Run a command; when standard input ends before, kill it and all that it began."""

_PR_SET_PDEATHSIG = 1


def run(words: Sequence[str], **options: Any) -> subprocess.CompletedProcess[str]:
    r"""Run a command to its end; one that is not over when this process ends, ends with it.

    Args:
        words: the command. It has no standard input.
        options: for `subprocess.run`.

    Returns:
        Its exit code, 128 and the signal's number if one ended it, and what it said.

    Raises:
        OSError: it cannot be run.
        subprocess.TimeoutExpired: it took longer than the option `timeout` allows.

    >>> run(["echo", "hello"]).stdout
    'hello\n'
    """
    import subprocess

    options = {"capture_output": True, "encoding": "utf-8", "errors": "replace", **options}
    if os.name != "posix":
        return subprocess.run(words, stdin=subprocess.DEVNULL, check=False, **options)  # noqa: S603
    watched, held = os.pipe()
    shell = ["/bin/sh", "-c", _WATCHED, "sh", *words]
    try:
        return subprocess.run(  # noqa: S603 - the caller's words
            shell, stdin=watched, start_new_session=True, check=False, **options
        )
    finally:
        os.close(held)
        os.close(watched)


@contextmanager
def interrupted_by_sigterm() -> Iterator[None]:
    """A request to end interrupts as Ctrl-C does: what was begun is ended, and cleaned up.

    Only the main thread can say so.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    known = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL if known is None else known)


@contextmanager
def workers(count: int, method: str | None = None) -> Iterator[ProcessPoolExecutor]:
    """Processes to share work among, to be begun by the thread that asks for them.

    They end with the block; what is waiting then is not begun, and an interrupt also ends what is
    under way.

    Args:
        count: processes at most.
        method: how they are begun, as `multiprocessing` names it; default: as the system does.

    Raises:
        WorkerLostError: one was ended from outside, and its work is lost.
    """
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool

    context = multiprocessing.get_context(method)
    watched, held = context.Pipe(duplex=False)
    # A signal at the death of the parent comes when its thread ends; the main one is the last.
    forked = context.get_start_method() != "forkserver"
    is_main = threading.current_thread() is threading.main_thread()
    parent = os.getpid() if forked and is_main else None
    pool = ProcessPoolExecutor(
        count, mp_context=context, initializer=_begin, initargs=(watched, held, parent)
    )
    try:
        yield pool
    except BrokenProcessPool:
        raise WorkerLostError(
            "a process that shared the work was ended from outside, as systems do when memory runs "
            "out: use fewer processes (jobs)"
        ) from None
    except Exception:
        raise
    except BaseException:  # interrupted, or nobody wants the rest
        held.send_bytes(b"end")
        raise
    finally:
        pool.shutdown(cancel_futures=True)
        held.close()
        watched.close()


def _begin(watched: Connection, held: Connection, parent: int | None) -> None:
    """Begin a worker.

    Args:
        watched: something comes, or it ends, when the worker is to end.
        held: the other end, which only the parent is to hold.
        parent: the process whose death Linux is to tell; `None`: nobody's.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent is interrupted as well, and decides
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    held.close()
    if parent is not None and sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        if os.getppid() != parent:  # it died before
            os._exit(1)
    threading.Thread(target=_end_with, args=(watched,), daemon=True).start()


def _end_with(watched: Connection) -> None:
    from multiprocessing.connection import wait

    wait([watched])
    os._exit(1)
