"""`parallel.execute` on the workers of a Dask scheduler.

A lost worker costs only time, because Dask gives its tasks to another. Each worker does one task at
a time, however many threads it has.
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

CONNECT_S = 10  # seconds within which a scheduler has to answer
NO_WORKERS_S = 60.0  # seconds to wait for a first worker
LEFT_S = 5.0  # seconds after a task's timeout until its worker exits unless it was restarted
_POLL_S = 0.5  # seconds between two checks for tasks that exceed their timeout


def execute_on_dask(work: Work, address: str) -> Iterator[Any]:
    """Do tasks as `parallel.execute` does, with Dask workers instead of processes.

    Args:
        work: the tasks; `instead` gives the result of a task whose workers were lost repeatedly, or
            which exceeded its timeout.
        address: of the scheduler, such as `tcp://10.0.0.5:8786`.

    Raises:
        WorkerLostError: there is no worker; or the workers of a task were lost repeatedly, and
            there is no `instead`.
        RvmonError: Dask is not installed, no scheduler answers, a worker has another rvmon, or a
            task cannot be pickled.
        Exception: whatever `prepare` or a task raised.
    """
    with needed("Dask", "distributed"):
        import cloudpickle
        from distributed import Client
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        cause = str(error).splitlines()[0]
        raise RvmonError(
            f"no Dask scheduler answers at {address} ({cause}): start one with `dask scheduler`, "
            f"and workers with `dask worker {address} --nthreads 1`"
        ) from None
    with client:
        yield from _Pool(client, cloudpickle.dumps(work.prepare), work).results()


class _Pool:
    """The tasks submitted to workers, and their results; see `parallel`."""

    def __init__(self, client: Any, prepare: bytes, work: Work) -> None:
        self._client = client
        self._work = work
        self._name = f"rvmon-{uuid.uuid4().hex}"
        # A task rather than scattered data, because Dask repeats a task whose worker is lost.
        self._prepare = client.submit(bytes, prepare, key=f"{self._name}-begin")
        self._tasks: dict[Any, tuple[int, bytes]] = {}
        self._starts: dict[int, tuple[float, str]] = {}
        self._finished: SimpleQueue[Any] = SimpleQueue()
        self._suspects: deque[tuple[int, bytes]] = deque()
        """Tasks whose workers were lost repeatedly; each is tried once more while no other runs."""
        self._alone: int | None = None
        self._done: dict[int, tuple[bool, bytes]] = {}
        client.subscribe_topic(self._name, self._note_start)

    def results(self) -> Iterator[Any]:
        """The results in the order of the tasks."""
        left = self._packed(self._work.tasks)
        number = 0
        seen = time.monotonic()
        while True:
            threads = sum(self._client.nthreads().values())
            seen = time.monotonic() if threads else seen
            if time.monotonic() - seen > NO_WORKERS_S:
                raise WorkerLostError("the Dask scheduler has no worker: start one")
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
                self._restart_late_workers()
            elif threads:
                return
            else:
                time.sleep(_POLL_S)

    def _packed(self, tasks: Iterable[Any]) -> Iterator[tuple[int, bytes]]:
        """The tasks, numbered and pickled; an exception is kept as the result of its task."""
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
        arguments = (*about, self._prepare, task)
        future = self._client.submit(_do, *arguments, pure=False, priority=-number)
        self._tasks[future] = (number, task)
        future.add_done_callback(self._finished.put)

    def _note_start(self, event: tuple[float, tuple[int, str]]) -> None:
        """Handle the event that a worker starts a task: remember the time and the worker."""
        number, worker = event[1]
        self._starts[number] = (time.monotonic(), worker)

    def _take(self, future: Any) -> None:
        from distributed import CancelledError, KilledWorker

        if future not in self._tasks:  # cancelled by `_restart_late_workers`
            return
        number, task = self._tasks.pop(future)
        try:
            self._done[number] = future.result()
        except (KilledWorker, CancelledError):
            if number == self._alone:
                self._lose(number, task, "the workers that had it were lost", timed_out=False)
            # The task may have been waiting, or its result stored, on a worker that another task
            # brought down. So it is no culprit until it is lost when run alone.
            else:
                self._suspects.append((number, task))
        self._starts.pop(number, None)

    def _restart_late_workers(self) -> None:
        """Restart the workers whose tasks exceed their timeout."""
        if self._work.timeout_s is None:
            return
        for future, (number, task) in [*self._tasks.items()]:
            since, worker = self._starts.get(number, (time.monotonic(), ""))
            if time.monotonic() - since <= self._work.timeout_s or future.done():
                continue
            if worker not in self._client.nthreads():  # lost: the task waits for another worker
                del self._starts[number]
                continue
            del self._tasks[future]
            future.cancel(force=True)
            with suppress(KeyError):  # raised by Dask if the worker was lost just now
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
        ended = Ended(timed_out, why, now - self._starts.get(number, (now, ""))[0])
        result = self._work.instead(pickle.loads(task), ended)  # noqa: S301 - packed here
        self._done[number] = (False, pickle.dumps(result))


program = cache(checksum)  # checksum of rvmon and Python, which must be equal on all workers

_ONE_AT_A_TIME = threading.Lock()
_WORK: dict[str, Callable[[Any], Any]] = {}
"""In a worker: the function that does tasks, by the name of the work; only the latest is kept."""


def _do(
    name: str,
    number: int,
    wanted: str,
    folder: str,
    timeout_s: float | None,
    prepare: bytes,
    task: bytes,
) -> tuple[bool, bytes]:
    """Do a task in a worker, in the client's folder if it exists here; report the start."""
    from distributed import get_worker

    late = threading.Timer((timeout_s or 0.0) + LEFT_S, os._exit, [1])
    late.daemon = True

    def prepared() -> Callable[[Any], Any]:
        worker = get_worker()
        if name not in _WORK:
            if program() != wanted:
                where = worker.address
                raise RvmonError(f"the worker {where} has another rvmon or Python: use one version")
            _WORK.clear()
            with suppress(OSError):
                os.chdir(folder)
            _WORK[name] = pickle.loads(prepare)()  # noqa: S301 - from who has the work
        worker.log_event(name, (number, worker.address))
        if timeout_s is not None:
            late.start()
        return _WORK[name]

    with _ONE_AT_A_TIME:
        try:
            return answer(prepared, task)
        finally:
            late.cancel()
