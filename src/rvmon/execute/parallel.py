"""One function applied to many tasks, in this process or several; results keep their order."""

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

MOST_TASKS = 256  # the most tasks of a chunk
START_S = 60.0  # seconds that a worker may take to start, in addition to the timeout of a task


def execute(
    tasks: Iterable[_Task],
    prepare: Callable[[], Callable[[_Task], _Result]],
    *,
    jobs: int | str,
    what: str = "task",
    instead: Callable[[_Task, Ended], _Result] | None = None,
    timeout_s: float | None = None,
    fresh: bool = False,
) -> Generator[_Result, None, None]:
    """Do tasks in several processes; results come in the order of the tasks.

    Worker processes start when the first result is requested, in the requesting thread. They end
    with the last result, when the generator is closed, by an interrupt, and with this process,
    however it ends. Workers get their tasks in chunks. A chunk holds about 0.1 s of work, so one
    slow task delays only the results of its own chunk. Chunks shrink when few tasks are left, so
    that all workers finish at about the same time.

    Args:
        tasks: consumed as workers become free; with several processes they must be picklable.
        prepare: called once in each process before its first task; it returns the function that
            does a task. Where processes are not forked, it is pickled once per process.
        jobs: the most processes; with 1, this process does all tasks, unless `instead` is given. Or
            the address of a Dask scheduler, whose workers do all tasks.
        what: the word for a task in messages.
        instead: gives the result of a task whose process was killed; further processes do the
            remaining tasks.
        timeout_s: with `instead`, seconds after which the process of a task is killed; the start of
            the process may take a minute more.
        fresh: with several processes or `instead`, start a new process for each task.

    Raises:
        WorkerLostError: a process was killed from outside and there is no `instead`; the message
            names its task.
        RvmonError: a task cannot be pickled, or no process can be started.
        Exception: whatever `prepare`, a task, or the iterator of `tasks` raised. Any of these
            errors is raised after the results of all earlier tasks.

    >>> list(execute([1, 2, 3], lambda: abs, jobs=1))
    [1, 2, 3]
    """
    whole = Work(tasks, prepare, what, instead, timeout_s)
    if isinstance(jobs, str):
        from rvmon.execute.on_dask import execute_on_dask

        yield from execute_on_dask(whole, jobs)
        return
    if jobs > 1 or instead is not None:
        pool = _Pool(whole, jobs, fresh)
        try:
            yield from pool.results()
        finally:
            pool.end()
        return
    work = prepare()
    for task in tasks:
        yield work(task)


class _Worker(Struct, eq=False):
    """A worker process, as its parent sees it."""

    process: BaseProcess
    connection: Connection
    # number of tasks it has started in all, and the time of the last start (monotonic clock)
    started: Sequence[float]
    # the tasks of its present chunk: number, ascending, and pickle
    tasks: list[tuple[int, bytes]] = field(default_factory=list)
    answered: int = 0  # number of tasks answered in earlier chunks
    size: int = 1  # size of its next chunk
    since: float = 0.0  # time when it got the present chunk (monotonic clock)

    def task_s(self) -> float:
        """Seconds since it started its present task, or got the chunk if it has not started."""
        return time.monotonic() - max(self.since, self.started[1])


class _Pool:
    """The workers, their tasks and their results; arguments as for `execute`."""

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
        """Kill all processes, whatever they are doing."""
        # Kill all before waiting for any, so that they end concurrently.
        for worker in self._workers:
            worker.process.kill()
            worker.connection.close()
        for worker in self._workers:
            worker.process.join()

    def results(self) -> Iterator[Any]:
        """The results in the order of the tasks."""
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
            answered = wait(busy, self._seconds_to_wait(busy.values()))
            for connection in answered:
                self._take(busy[connection])
            for connection in busy.keys() - answered:
                self._end_if_late(busy[connection])

    def _share(self) -> None:
        """Give tasks to all idle workers, then start further workers while tasks are left."""
        resting = [worker for worker in self._workers if not worker.tasks]
        while resting or len(self._workers) < self._jobs:
            size = min(resting[-1].size, self._share_of_rest()) if resting else 1
            chunk = list(islice(self._remaining_tasks(), size))
            if not chunk:
                return
            worker = resting.pop() if resting else self._start_worker()
            worker.tasks = chunk
            worker.since = time.monotonic()
            with suppress(OSError):  # the worker was killed: `_take` will notice
                worker.connection.send([task for _, task in chunk])

    def _share_of_rest(self) -> int:
        """The most tasks of a chunk: half of a worker's equal share of the remaining tasks."""
        unknown = 2 * self._jobs * MOST_TASKS
        left = len(self._returned) + length_hint(self._tasks, unknown)
        return max(1, left // (2 * self._jobs))

    def _start_worker(self) -> _Worker:
        from rvmon.execute.worker import serve

        # Linux sends the parent-death signal when the thread that started the process ends, so it
        # can only be used from the main thread, which ends last.
        forked = self._context.get_start_method() != "forkserver"
        is_main = threading.current_thread() is threading.main_thread()
        parent = os.getpid() if forked and is_main else None
        here, there = self._context.Pipe()
        started = self._context.RawArray("d", 2)
        arguments = (there, here, self._work.prepare, parent, started)
        process = self._context.Process(target=serve, args=arguments, daemon=True)
        try:
            with _interrupts_blocked():
                process.start()
        except OSError as error:
            message = f"no process can be started ({error.strerror}): use fewer (jobs)"
            raise RvmonError(message) from None
        there.close()
        self._workers.append(_Worker(process, here, started))
        return self._workers[-1]

    def _remaining_tasks(self) -> Iterator[tuple[int, bytes]]:
        """The tasks that no worker has, in ascending order of number."""
        # First the tasks that workers gave back: their numbers are lower, and the results, which
        # come in order, wait for the lowest.
        while self._returned:
            yield heappop(self._returned)
        try:
            for task in self._tasks:
                packed = self._packed(task)
                self._taken += 1
                yield self._taken - 1, packed
        except Exception as error:  # noqa: BLE001 - raised after the results of earlier tasks
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
        """Receive the answers of a worker, or find that it was killed."""
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
        # A worker answers after about 0.1 s. If it did only a part of the chunk, that part is the
        # right size for the next one.
        worker.size = done if done < len(worker.tasks) else min(2 * done, MOST_TASKS)
        self._give_back(worker, worker.tasks[done:])
        if self._fresh:
            worker.process.kill()
            self._dismiss(worker)

    def _seconds_to_wait(self, busy: Iterable[_Worker]) -> float | None:
        """Seconds until a timeout can expire, also that of a task that starts meanwhile."""
        if self._work.timeout_s is None:
            return None
        return max(0.0, min(self._work.timeout_s, *map(self._left_s, busy)))

    def _left_s(self, worker: _Worker) -> float:
        """Seconds until the timeout of a worker's task."""
        if self._work.timeout_s is None:
            return inf
        started = worker.started[0]
        most = self._work.timeout_s if started else self._work.timeout_s + START_S
        return most - worker.task_s()

    def _end_if_late(self, worker: _Worker) -> None:
        """Kill a worker whose task exceeds its timeout, unless its answer has just arrived."""
        if self._left_s(worker) <= 0 and not worker.connection.poll():
            worker.process.kill()
            self._lose(worker, timed_out=True)

    def _lose(self, worker: _Worker, *, timed_out: bool) -> None:
        """Remove a killed worker; its present task fails, its other tasks are given back."""
        seconds = worker.task_s()
        self._dismiss(worker)
        started = int(worker.started[0])
        if started and started == worker.answered:  # killed while idle: no task is to blame
            self._give_back(worker, worker.tasks)
            return
        # The answers to earlier tasks of the chunk are lost, so these are done again.
        number, task = worker.tasks.pop(max(0, started - worker.answered - 1))
        self._give_back(worker, worker.tasks)
        if self._work.instead is None:
            message = (
                f"the process that had {self._work.what} {number + 1} was killed from outside, as "
                "systems do when memory runs out: use fewer processes (jobs)"
            )
            self._fail(number, WorkerLostError(message))
            return
        why = (
            f"it took more than {self._work.timeout_s:g} s"
            if timed_out
            else _how_it_ended(worker.process)
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
        """Record the error of a task; no further tasks are started."""
        self._done[number] = error
        self._tasks = iter(())


def _how_it_ended(process: BaseProcess) -> str:
    code = process.exitcode
    if code is None or code >= 0:
        return f"its process ended, with exit code {code}"
    try:
        name = signal.Signals(-code).name
    except ValueError:
        name = str(-code)
    return f"its process was killed by signal {name}"


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Block interrupts, so that a process started here is never interrupted before it ignores them.

    Ctrl-C reaches all processes of a terminal; only the parent is to react to it.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    known = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, known)
