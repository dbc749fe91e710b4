"""`parallel.execute` on the workers of a scheduler of Dask, wherever these are.

A worker that is lost costs nothing but time: Dask gives what it had to another. Each does one task
at a time, however many threads it has.
"""

from __future__ import annotations

import os
import pickle
import threading
import time
import uuid
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import cache
from itertools import islice
from queue import Empty, SimpleQueue
from typing import Any

from rvmon.errors import RvmonError, WorkerLostError, needed
from rvmon.execute import Ended, Work
from rvmon.execute.journal import checksum
from rvmon.execute.worker import answer, packed_error

CONNECT_S = 10  # seconds in which a scheduler has to answer
NO_WORKERS_S = 60.0  # seconds for which one waits for a worker where there is none
LEFT_S = 5.0  # seconds after its time in which a worker ends by itself that was not begun anew
_POLL_S = 0.5  # seconds after which one looks again for what takes too long


def execute_on_dask(work: Work, address: str) -> Iterator[Any]:
    """Do tasks as `parallel.execute` does; what is said there of processes is of workers here.

    Args:
        work: the tasks; `instead` gives the result of a task whose worker was lost again
            and again, or took too long.
        address: of the scheduler, such as `tcp://10.0.0.5:8786`.

    Raises:
        WorkerLostError: there is no worker; or those that had a task were lost, and there is no
            `instead`.
        RvmonError: Dask is not installed, no scheduler answers, a worker has another rvmon, or a
            task cannot be pickled.
        Exception: what `begin` or a task raised.
    """
    with needed("Dask", "distributed"):
        import cloudpickle
        from distributed import Client
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        cause = str(error).splitlines()[0]
        raise RvmonError(
            f"no scheduler of Dask answers at {address} ({cause}): begin one by `dask scheduler`, "
            f"and workers by `dask worker {address} --nthreads 1`"
        ) from None
    with client:
        yield from _Pool(client, cloudpickle.dumps(work.begin), work).results()


class _Pool:
    """The tasks given to workers, and their results; see `parallel`."""

    def __init__(self, client: Any, begin: bytes, work: Work) -> None:
        self._client = client
        self._work = work
        self._name = f"rvmon-{uuid.uuid4().hex}"
        # A task rather than data that is handed out: it is done again where its worker is lost.
        self._begin = client.submit(bytes, begin, key=f"{self._name}-begin")
        self._tasks: dict[Any, tuple[int, bytes]] = {}
        self._begun: dict[int, tuple[float, str]] = {}
        self._finished: SimpleQueue[Any] = SimpleQueue()
        self._suspects: deque[tuple[int, bytes]] = deque()
        """Tasks whose workers were lost again and again; each is tried once more, alone."""
        self._alone: int | None = None
        self._done: dict[int, tuple[bool, bytes]] = {}
        client.subscribe_topic(self._name, self._note)

    def results(self) -> Iterator[Any]:
        """The results in order."""
        left = self._packed(self._work.tasks)
        number = 0
        seen = time.monotonic()
        while True:
            threads = sum(self._client.nthreads().values())
            seen = time.monotonic() if threads else seen
            if time.monotonic() - seen > NO_WORKERS_S:
                raise WorkerLostError("the scheduler of Dask has no worker: begin one")
            if not self._suspects:
                for one in islice(left, max(0, 2 * threads - len(self._tasks))):
                    self._submit(*one)
            elif not self._tasks:
                self._alone = self._suspects[0][0]
                self._submit(*self._suspects.popleft())
            if number in self._done:
                failed, result = self._done.pop(number)
                if failed:
                    raise pickle.loads(result)  # noqa: S301 - from a worker of ours
                yield pickle.loads(result)  # noqa: S301 - as above
                number += 1
            elif self._tasks:
                with suppress(Empty):
                    self._take(self._finished.get(timeout=_POLL_S))
                self._end_late()
            elif threads:
                return
            else:
                time.sleep(_POLL_S)

    def _packed(self, tasks: Iterable[Any]) -> Iterator[tuple[int, bytes]]:
        """Tasks by number; what cannot be taken, or pickled, is raised in its turn."""
        import cloudpickle

        number = 0
        try:
            for task in tasks:
                yield number, cloudpickle.dumps(task)
                number += 1
        except Exception as error:  # noqa: BLE001 - as in `parallel`
            self._done[number] = (True, packed_error(error))

    def _submit(self, number: int, task: bytes) -> None:
        about = (self._name, number, program(), os.getcwd(), self._work.timeout_s)
        arguments = (*about, self._begin, task)
        future = self._client.submit(_do, *arguments, pure=False, priority=-number)
        self._tasks[future] = (number, task)
        future.add_done_callback(self._finished.put)

    def _note(self, event: tuple[float, tuple[int, str]]) -> None:
        """A worker begins a task: take down when, and which worker."""
        number, worker = event[1]
        self._begun[number] = (time.monotonic(), worker)

    def _take(self, future: Any) -> None:
        from distributed import CancelledError, KilledWorker

        if future not in self._tasks:  # given up before
            return
        number, task = self._tasks.pop(future)
        try:
            self._done[number] = future.result()
        except (KilledWorker, CancelledError):
            if number == self._alone:
                self._lose(number, task, "the workers that had it were lost", timed_out=False)
            else:  # it may have waited, or its result, where another task was done
                self._suspects.append((number, task))
        self._begun.pop(number, None)

    def _end_late(self) -> None:
        """Begin those workers anew whose tasks take too long."""
        if self._work.timeout_s is None:
            return
        for future, (number, task) in [*self._tasks.items()]:
            since, worker = self._begun.get(number, (time.monotonic(), ""))
            if time.monotonic() - since <= self._work.timeout_s or future.done():
                continue
            if worker not in self._client.nthreads():  # lost: the task waits for another
                del self._begun[number]
                continue
            del self._tasks[future]
            future.cancel(force=True)
            with suppress(KeyError):  # Dask's, of a worker that was lost just now
                self._client.restart_workers([worker], raise_for_error=False)
            self._lose(
                number, task, f"it took more than {self._work.timeout_s:g} s", timed_out=True
            )

    def _lose(self, number: int, task: bytes, why: str, *, timed_out: bool) -> None:
        if self._work.instead is None:
            error = WorkerLostError(f"{self._work.what} {number + 1} was not done: {why}")
            self._done[number] = (True, pickle.dumps(error))
            return
        now = time.monotonic()
        ended = Ended(timed_out, why, now - self._begun.get(number, (now, ""))[0])
        result = self._work.instead(pickle.loads(task), ended)  # noqa: S301 - packed here
        self._done[number] = (False, pickle.dumps(result))


program = cache(checksum)  # a checksum of the program: only results of equal programs can be mixed

_ONE_AT_A_TIME = threading.Lock()
_WORK: dict[str, Callable[[Any], Any]] = {}
"""In a worker: what does tasks, by the name of the work; the last one."""


def _do(
    name: str,
    number: int,
    wanted: str,
    folder: str,
    timeout_s: float | None,
    begin: bytes,
    task: bytes,
) -> tuple[bool, bytes]:
    """Do a task in a worker, in the folder of who has the work if there is one; say when."""
    from distributed import get_worker

    late = threading.Timer((timeout_s or 0.0) + LEFT_S, os._exit, [1])
    late.daemon = True

    def begun() -> Callable[[Any], Any]:
        worker = get_worker()
        if name not in _WORK:
            if program() != wanted:
                where = worker.address
                raise RvmonError(f"the worker {where} has another rvmon or Python: use one version")
            _WORK.clear()
            with suppress(OSError):
                os.chdir(folder)
            _WORK[name] = pickle.loads(begin)()  # noqa: S301 - from who has the work
        worker.log_event(name, (number, worker.address))
        if timeout_s is not None:
            late.start()
        return _WORK[name]

    with _ONE_AT_A_TIME:
        try:
            return answer(begun, task)
        finally:
            late.cancel()
