"""Execution of many tasks: worker processes, external commands, journals and shards.

`parallel.execute` distributes tasks over processes or over the workers of a Dask scheduler; no
other module starts Python processes. No process outlives the one that started it. `journal` writes
results to disk as they come, so that interrupted work can be resumed. A `Shard` is a share of the
work for one of several machines, which need not know each other; a final run without a shard, in a
folder that contains all their journals, takes the results from these. `run_command` runs a program.
`interrupted_by_sigterm` cleans up after SIGTERM, too.
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
    """How the process of an unfinished task ended."""

    timed_out: bool  # whether it was killed because the task exceeded its timeout
    why: str  # the cause, for people
    seconds: float  # wall time from the start of the task


class Work(NamedTuple):
    """Arguments of `parallel.execute`; see there."""

    tasks: Iterable[Any]
    prepare: Callable[[], Callable[[Any], Any]]
    what: str
    instead: Callable[[Any, Ended], Any] | None
    timeout_s: float | None


@contextmanager
def interrupted_by_sigterm() -> Iterator[None]:
    """Within the block, SIGTERM raises KeyboardInterrupt as Ctrl-C does, so that cleanup runs.

    Outside the main thread, where Python cannot set signal handlers, it does nothing.
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
    """One of `total` shares of equal size, numbered from 1."""

    number: int
    total: int

    def __str__(self) -> str:
        return f"{self.number}/{self.total}"

    def of(self, tasks: Sequence[_Task]) -> list[_Task]:
        """The tasks of this share; each task belongs to exactly one share.

        >>> [Shard(number, 2).of("abcde") for number in (1, 2)]
        [['a', 'c', 'e'], ['b', 'd']]
        """
        return list(tasks[self.number - 1 :: self.total])

    def name(self, path: Path) -> Path:
        """The file that this shard writes instead of `path`, the file of the whole work.

        >>> Shard(2, 4).name(Path("out/verdicts.csv")).name
        'verdicts.shard-2-of-4.csv'
        """
        return path.with_name(f"{path.stem}.shard-{self.number}-of-{self.total}{path.suffix}")


def finished_shards(path: Path) -> list[Path]:
    """The existing files of shards of the file `path`, sorted by name.

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
"""Shell script: run a command; if standard input closes before it ends, kill the process group."""


def run_command(words: Sequence[str], **options: Any) -> subprocess.CompletedProcess[str]:
    r"""Run a command to its end; if this process ends first, the command is killed.

    Args:
        words: the command and its arguments. Its standard input is empty.
        options: for `subprocess.run`.

    Returns:
        Its exit code and output; the exit code is 128 plus the signal number if a signal ended it.

    Raises:
        OSError: the command cannot be run.
        subprocess.TimeoutExpired: it took longer than the option `timeout` allows.

    >>> run_command(["echo", "hello"]).stdout
    'hello\n'
    """
    import subprocess

    options = {"capture_output": True, "encoding": "utf-8", "errors": "replace", **options}
    if os.name != "posix":
        return subprocess.run(words, stdin=subprocess.DEVNULL, check=False, **options)  # noqa: S603 - words, no shell
    # However this process ends, also by SIGKILL, the system closes the pipe. Then `read` returns
    # and the shell kills its process group, which contains nothing else due to the new session.
    watched, held = os.pipe()
    shell = ["/bin/sh", "-c", _WATCHED, "sh", *words]
    try:
        return subprocess.run(  # noqa: S603 - the caller's words
            shell, stdin=watched, start_new_session=True, check=False, **options
        )
    finally:
        os.close(held)
        os.close(watched)
