"""One function done on many tasks, in this process or in several; the results keep their order."""

from __future__ import annotations

import os
import pickle
import signal
import threading
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from heapq import heappop, heappush
from itertools import islice
from math import inf
from operator import length_hint
from typing import TYPE_CHECKING, Any, TypeVar

from msgspec import Struct, field

from rvmon.errors import RvmonError, WorkerLostError
from rvmon.execute import Ended, Work

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

_Task = TypeVar("_Task")
_Result = TypeVar("_Result")

MOST_TASKS = 256  # tasks that a worker is given at a time, at most
BEGIN_S = 60.0  # seconds that a worker may take to begin, beside those for a task


def execute(
    tasks: Iterable[_Task],
    begin: Callable[[], Callable[[_Task], _Result]],
    *,
    jobs: int | str,
    what: str = "task",
    instead: Callable[[_Task, Ended], _Result] | None = None,
    timeout_s: float | None = None,
    fresh: bool = False,
) -> Generator[_Result, None, None]:
    """Do tasks, shared among processes; the results come in the order of the tasks.

    The processes are begun, by the thread that asks for them, for the first result. They end with
    the last result, with the iterator, by an interrupt, and with this process, however it ends.
    Tasks go to them in chunks: of so many as take about 0.1 s, so that a task which takes longer
    holds up no others, but for the results of its chunk; of few where few are left, so that all
    processes end together.

    Args:
        tasks: taken from as processes have time; for several processes what can be pickled.
        begin: called once in each process, before its first task; what it returns does a task.
            Where processes are not forked, it is pickled, once for each.
        jobs: processes at most; 1: this process does all, unless `instead` is given. Or the address
            of a scheduler of Dask, whose workers do all.
        what: the word for a task in messages.
        instead: the result of a task whose process was ended; the other tasks are done all the
            same, by other processes.
        timeout_s: with `instead`, seconds after which the process of a task is ended; that it
            begins may take a minute more.
        fresh: with several processes or `instead`, each task has a process of its own.

    Raises:
        WorkerLostError: a process was ended from outside, and there is no `instead`; the task that
            it had is named.
        RvmonError: a task cannot be pickled, or no process be begun.
        Exception: what `begin`, a task, or taking the next of `tasks` raised. As for the others,
            the results of all tasks before have been given out.

    >>> list(execute([1, 2, 3], lambda: abs, jobs=1))
    [1, 2, 3]
    """
    asked = Work(tasks, begin, what, instead, timeout_s)
    if isinstance(jobs, str):
        from rvmon.execute.on_dask import execute_on_dask

        yield from execute_on_dask(asked, jobs)
        return
    if jobs > 1 or instead is not None:
        pool = _Pool(asked, jobs, fresh)
        try:
            yield from pool.results()
        finally:
            pool.end()
        return
    work = begin()
    for task in tasks:
        yield work(task)


class _Worker(Struct, eq=False):
    """A process that works, seen from here."""

    process: BaseProcess  # itself
    connection: Connection  # to it
    # how many tasks it has begun in all, and when the last, on the monotonic clock
    begun: Sequence[float]
    tasks: list[tuple[int, bytes]] = field(default_factory=list)  # numbers, ascending, and pickles
    answered: int = 0  # tasks before these
    size: int = 1  # tasks of its next chunk
    since: float = 0.0  # when it was given these, on the monotonic clock

    def task_s(self) -> float:
        """Seconds for which it has had the task that it does, or is to begin with."""
        return time.monotonic() - max(self.since, self.begun[1])


class _Pool:
    """Workers, what they have, and what they have done; `execute` says what the arguments are."""

    def __init__(self, work: Work, jobs: int, fresh: bool) -> None:
        import multiprocessing

        self._work, self._tasks = work, iter(work.tasks)
        self._jobs = jobs
        self._fresh = fresh
        self._context = multiprocessing.get_context()
        self._workers: list[_Worker] = []
        self._taken = 0
        self._returned: list[tuple[int, bytes]] = []
        self._done: dict[int, bytes | Exception] = {}

    def end(self) -> None:
        """End all processes at once, whatever they do."""
        # All are killed before any is waited for, so that they end together.
        for worker in self._workers:
            worker.process.kill()
            worker.connection.close()
        for worker in self._workers:
            worker.process.join()

    def results(self) -> Iterator[Any]:
        """The results in order."""
        from multiprocessing.connection import wait

        number = 0
        while True:
            self._share()
            if number in self._done:
                result = self._done.pop(number)
                if isinstance(result, Exception):
                    raise result
                yield pickle.loads(result)  # noqa: S301 - from a process that was begun here
                number += 1
                continue
            busy: dict[Any, _Worker] = {
                worker.connection: worker for worker in self._workers if worker.tasks
            }
            if not busy:
                return
            answered = wait(busy, self._patience(busy.values()))
            for connection in answered:
                self._take(busy[connection])
            for connection in busy.keys() - answered:
                self._end_if_late(busy[connection])

    def _share(self) -> None:
        """Give tasks to all workers that have none; if there are more, to further ones."""
        resting = [worker for worker in self._workers if not worker.tasks]
        while resting or len(self._workers) < self._jobs:
            size = min(resting[-1].size, self._share_of_rest()) if resting else 1
            chunk = list(islice(self._left(), size))
            if not chunk:
                return
            worker = resting.pop() if resting else self._begun()
            worker.tasks = chunk
            worker.since = time.monotonic()
            with suppress(OSError):  # it was ended: no answer will say so
                worker.connection.send([task for _, task in chunk])

    def _share_of_rest(self) -> int:
        """The most tasks of a chunk: half of what each worker would get of those that are left."""
        unknown = 2 * self._jobs * MOST_TASKS
        left = len(self._returned) + length_hint(self._tasks, unknown)
        return max(1, left // (2 * self._jobs))

    def _begun(self) -> _Worker:
        from rvmon.execute.worker import serve

        # A signal at the death of the parent comes when its thread ends; the main one is the last.
        forked = self._context.get_start_method() != "forkserver"
        is_main = threading.current_thread() is threading.main_thread()
        parent = os.getpid() if forked and is_main else None
        here, there = self._context.Pipe()
        begun = self._context.RawArray("d", 2)
        arguments = (there, here, self._work.begin, parent, begun)
        process = self._context.Process(target=serve, args=arguments, daemon=True)
        try:
            with _without_interrupts():
                process.start()
        except OSError as error:
            message = f"no process can be begun ({error.strerror}): use fewer (jobs)"
            raise RvmonError(message) from None
        there.close()
        self._workers.append(_Worker(process, here, begun))
        return self._workers[-1]

    def _left(self) -> Iterator[tuple[int, bytes]]:
        """The tasks that no worker has, ascending."""
        # Those of lost workers first, the lowest number first: results come in order, and wait for
        # it.
        while self._returned:
            yield heappop(self._returned)
        try:
            for task in self._tasks:
                packed = self._packed(task)
                self._taken += 1
                yield self._taken - 1, packed
        except Exception as error:  # noqa: BLE001 - raised in its turn
            self._fail(self._taken, error)

    def _packed(self, task: Any) -> bytes:
        try:
            return pickle.dumps(task)
        except (pickle.PicklingError, TypeError, AttributeError) as error:
            raise RvmonError(
                f"{self._work.what} {self._taken + 1} cannot be given to another process "
                f"({error}): use one process (jobs)"
            ) from None

    def _take(self, worker: _Worker) -> None:
        """Take the answers of a worker, or that there will be none."""
        try:
            answers = worker.connection.recv()
        except (EOFError, OSError):
            self._lose(worker, timed_out=False)
            return
        done = len(answers)
        for (number, _), (failed, result) in zip(worker.tasks, answers, strict=False):
            if failed:
                self._fail(number, pickle.loads(result))  # noqa: S301 - as above
            else:
                self._done[number] = result
        worker.answered += done
        worker.size = done if done < len(worker.tasks) else min(2 * done, MOST_TASKS)
        self._give_back(worker, worker.tasks[done:])
        if self._fresh:
            worker.process.kill()
            self._dismiss(worker)

    def _patience(self, busy: Iterable[_Worker]) -> float | None:
        """Seconds until the first task may have taken too long, whenever it is begun."""
        if self._work.timeout_s is None:
            return None
        return max(0.0, min(self._work.timeout_s, *map(self._left_s, busy)))

    def _left_s(self, worker: _Worker) -> float:
        """Seconds that a worker's task may still take."""
        if self._work.timeout_s is None:
            return inf
        begun = worker.begun[0]
        most = self._work.timeout_s if begun else self._work.timeout_s + BEGIN_S
        return most - worker.task_s()

    def _end_if_late(self, worker: _Worker) -> None:
        """End a worker whose task takes too long, unless its answer has just come."""
        if self._left_s(worker) <= 0 and not worker.connection.poll():
            worker.process.kill()
            self._lose(worker, timed_out=True)

    def _lose(self, worker: _Worker, *, timed_out: bool) -> None:
        """Do without a worker that was ended, and without a result of the task that it did."""
        seconds = worker.task_s()
        self._dismiss(worker)
        begun = int(worker.begun[0])
        if begun and begun == worker.answered:  # it was ended while it waited: no task is to blame
            self._give_back(worker, worker.tasks)
            return
        # It did the tasks before, but nobody will get its answers: they are done once more.
        number, task = worker.tasks.pop(max(0, begun - worker.answered - 1))
        self._give_back(worker, worker.tasks)
        if self._work.instead is None:
            message = (
                f"the process that had {self._work.what} {number + 1} was ended from outside, as "
                "systems do when memory runs out: use fewer processes (jobs)"
            )
            self._fail(number, WorkerLostError(message))
            return
        why = (
            f"it took more than {self._work.timeout_s:g} s"
            if timed_out
            else _end_of(worker.process)
        )
        ended = Ended(timed_out, why, seconds)
        result = self._work.instead(pickle.loads(task), ended)  # noqa: S301 - packed here
        self._done[number] = pickle.dumps(result)

    def _dismiss(self, worker: _Worker) -> None:
        self._workers.remove(worker)
        worker.connection.close()
        worker.process.join()

    def _give_back(self, worker: _Worker, tasks: Iterable[tuple[int, bytes]]) -> None:
        for task in tasks:
            heappush(self._returned, task)
        worker.tasks = []

    def _fail(self, number: int, error: Exception) -> None:
        """A task has no result: what comes behind it is not begun."""
        self._done[number] = error
        self._tasks = iter(())


def _end_of(process: BaseProcess) -> str:
    code = process.exitcode
    if code is None or code >= 0:
        return f"its process ended, with exit code {code}"
    try:
        name = signal.Signals(-code).name
    except ValueError:
        name = str(-code)
    return f"its process was ended by signal {name}"


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Processes that are begun here ignore Ctrl-C from their first instruction on: it waits.

    It reaches all processes of a terminal, and this one decides.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    known = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, known)
