"""Work for many tasks: processes that never outlive who began them, results that outlive all.

`parallel.execute` shares tasks among processes, or the workers of a scheduler of Dask; nothing else
starts any for Python's work. `journal` keeps results as they come, so that work which was ended
goes on; a shard is a share of the work that knows of no other.
`command.run` runs a program; `interrupted_by_sigterm` has all of them cleaned up.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, NamedTuple


@dataclass(frozen=True, slots=True)
class Ended:
    """The end of a task's process that did not finish.

    Attributes:
        timed_out: whether it was stopped here, as the task took too long.
        why: for people.
        seconds: wall time that the task had taken.
    """

    timed_out: bool
    why: str
    seconds: float


class Work(NamedTuple):
    """The tasks, and the words for their progress; see `parallel.execute`."""

    tasks: Iterable[Any]
    begin: Callable[[], Callable[[Any], Any]]
    what: str
    instead: Callable[[Any, Ended], Any] | None
    timeout_s: float | None


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
