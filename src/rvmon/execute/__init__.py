"""Work for many tasks: processes that never outlive who began them, results that outlive all.

`parallel.execute` shares tasks among processes, or the workers of a scheduler of Dask; nothing else
starts any for Python's work. `journal` keeps results as they come, so that work which was ended
goes on; a `Shard` is a share of the work for one of several machines, none of which knows of
another: begun without a shard where all their journals are, work finds in them what was done.
`run_command` runs a program; `interrupted_by_sigterm` has all of them cleaned up.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

if TYPE_CHECKING:
    import subprocess


class Ended(NamedTuple):
    """The end of a task's process that did not finish."""

    timed_out: bool  # whether it was stopped here, as the task took too long
    why: str  # for people
    seconds: float  # wall time that the task had taken


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


_Task = TypeVar("_Task")


class Shard(NamedTuple):
    """One of several shares that are as large as each other."""

    number: int
    total: int

    def __str__(self) -> str:
        return f"{self.number}/{self.total}"

    def of(self, tasks: Sequence[_Task]) -> list[_Task]:
        """The tasks of this share; all shares together have each task once.

        >>> [Shard(number, 2).of("abcde") for number in (1, 2)]
        [['a', 'c', 'e'], ['b', 'd']]
        """
        return list(tasks[self.number - 1 :: self.total])

    def name(self, path: Path) -> Path:
        """The file of this shard in place of the file `path` of the whole.

        >>> Shard(2, 4).name(Path("out/verdicts.csv")).name
        'verdicts.shard-2-of-4.csv'
        """
        return path.with_name(f"{path.stem}.shard-{self.number}-of-{self.total}{path.suffix}")


def finished_shards(path: Path) -> list[Path]:
    """The files of all finished shards in place of a file, by name.

    Raises:
        OSError: the folder cannot be read.
    """
    pattern = f"{_literal(path.stem)}.shard-*-of-*{_literal(path.suffix)}"
    return sorted(path.parent.glob(pattern))


def _literal(name: str) -> str:
    import glob

    return glob.escape(name)


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


def run_command(words: Sequence[str], **options: Any) -> subprocess.CompletedProcess[str]:
    r"""Run a command to its end; one that is not over when this process ends, ends with it.

    Args:
        words: the command. It has no standard input.
        options: for `subprocess.run`.

    Returns:
        Its exit code, 128 and the signal's number if one ended it, and what it printed.

    Raises:
        OSError: it cannot be run.
        subprocess.TimeoutExpired: it took longer than the option `timeout` allows.

    >>> run_command(["echo", "hello"]).stdout
    'hello\n'
    """
    import subprocess

    options = {"capture_output": True, "encoding": "utf-8", "errors": "replace", **options}
    if os.name != "posix":
        return subprocess.run(words, stdin=subprocess.DEVNULL, check=False, **options)  # noqa: S603 - words, no shell
    # The system closes the pipe however this process ends, also by SIGKILL; then `read` returns,
    # and the shell kills its process group, which the new session makes its own.
    watched, held = os.pipe()
    shell = ["/bin/sh", "-c", _WATCHED, "sh", *words]
    try:
        return subprocess.run(  # noqa: S603 - the caller's words
            shell, stdin=watched, start_new_session=True, check=False, **options
        )
    finally:
        os.close(held)
        os.close(watched)
