"""Tasks in several processes: order, errors, lost workers, and cleanup."""

import multiprocessing
import os
import pickle
import signal
import threading
import time
from functools import partial
from itertools import count, islice
from pathlib import Path

import pytest

import rvmon
from rvmon.errors import RvmonError, SpecError, TraceError, WorkerLostError
from rvmon.execute import parallel
from rvmon.execute.parallel import execute
from rvmon.monitor.records import give_plan

pytestmark = [
    pytest.mark.process,
    pytest.mark.skipif(
        multiprocessing.get_start_method() != "fork", reason="needs processes that are forked"
    ),
]

JOBS = pytest.mark.parametrize("jobs", [1, 2, 5])

PARENT = """
import multiprocessing, os, sys, time
from functools import partial
from rvmon.execute import interrupted_by_sigterm
from rvmon.execute.parallel import execute

def told(number):
    time.sleep(600 if number > 1 else 0.5)
    return os.getpid()

if __name__ == "__main__":
    multiprocessing.set_start_method(sys.argv[1])
    with interrupted_by_sigterm():
        done = execute(range(9), partial(partial, told), jobs=2)
        print(next(done), next(done), flush=True)
        list(done)
"""


def doing(work):
    """What `execute` needs: called in a worker, it returns the function for a task."""
    return partial(partial, work)


def halved(number):
    """Half of an even number; odd numbers raise, and 13 kills the process."""
    if number == 13:
        os.kill(os.getpid(), signal.SIGKILL)
    if number % 2:
        raise TraceError(f"{number} is odd")
    return number // 2


def given(results):
    """All results, and the error after them."""
    found = []
    try:
        found.extend(results)
    except Exception as error:  # noqa: BLE001 - asserted by who asks
        return found, error
    return found, None


def met(folder, last, number):
    """The last two of some tasks do not end before both have started."""
    if number >= last - 1:
        Path(folder, str(number)).touch()
        until = time.monotonic() + 20
        while len(os.listdir(folder)) < 2:
            assert time.monotonic() < until, "the other task waits for this one"
            time.sleep(0.001)
    return number


def test_all_processes_share_the_last_tasks(tmp_path):
    """However many tasks a chunk had before."""
    done = execute(range(500), doing(partial(met, tmp_path, 499)), jobs=2)
    assert list(done) == [*range(500)]


@JOBS
@pytest.mark.parametrize("size", [0, 1, 2, 1000])
def test_results_come_in_the_order_of_the_tasks(jobs, size):
    assert list(execute(range(size), doing(str), jobs=jobs)) == [*map(str, range(size))]


@JOBS
def test_slow_and_quick_tasks_keep_their_order(jobs):
    """If a slow task follows many quick ones, the rest of its chunk goes to others."""
    tasks = [0.0] * 40 + [0.3] + [0.0] * 300 + [0.2] * 3 + [0.0] * 40

    def slept(pair):
        time.sleep(pair[1])
        return pair[0]

    numbers = [*range(len(tasks))]
    assert list(execute(enumerate(tasks), lambda: slept, jobs=jobs)) == numbers


@JOBS
def test_work_begins_once_in_each_process(tmp_path, jobs):
    def begin():
        with (tmp_path / str(os.getpid())).open("a") as file:
            file.write("begun\n")
        return str

    list(execute(range(2000), begin, jobs=jobs))
    begun = [path.read_text() for path in tmp_path.iterdir()]
    assert begun == ["begun\n"] * len(begun)
    assert 1 <= len(begun) <= jobs


@pytest.mark.parametrize("jobs", [1, 2])
def test_each_task_can_have_a_process_of_its_own(jobs):
    """No state of one task is visible to the next; lost workers are replaced."""

    def told(number):
        return os._exit(3) if number == 2 else os.getpid()

    instead = {"instead": lambda _, ended: ended.why}
    found = list(execute(range(6), lambda: told, jobs=jobs, fresh=True, **instead))
    assert found[2] == "its process ended, with exit code 3"
    assert len({*found, os.getpid()}) == 7


@JOBS
def test_an_error_comes_in_its_turn(jobs):
    found, error = given(execute([*range(0, 200, 2), 7, 8, 9], doing(halved), jobs=jobs))
    assert found == [*range(100)]
    assert type(error) is TraceError
    assert str(error) == "7 is odd"


def test_an_error_does_not_wait_for_later_tasks():
    """A worker has several tasks at a time, and the later ones no longer matter."""

    def work(number):
        if number > 40:
            time.sleep(600)
        return halved(number)

    tasks = [*range(0, 40, 2), 7, *range(42, 100)]
    began = time.monotonic()
    found, error = given(execute(tasks, doing(work), jobs=2))
    assert (found, str(error)) == ([*range(20)], "7 is odd")
    assert time.monotonic() - began < 60


@JOBS
def test_an_error_of_the_tasks_themselves_comes_in_its_turn(jobs):
    """For example, if a list of files cannot be read to its end."""

    def tasks():
        yield from range(0, 100, 2)
        raise OSError("gone")

    found, error = given(execute(tasks(), doing(halved), jobs=jobs))
    assert found == [*range(50)]
    assert isinstance(error, OSError)


@JOBS
def test_an_error_at_the_beginning_is_that_of_the_first_task(jobs):
    def begin():
        rvmon.loads("spec s\nrequirement R\n  always p\n")

    found, error = given(execute(range(5), begin, jobs=jobs))
    assert not found
    assert isinstance(error, SpecError)
    assert [diagnostic.code for diagnostic in error.diagnostics] == ["RV012"]


def test_an_unexpected_error_has_its_traceback():
    """The traceback of a worker is not available elsewhere."""
    _, error = given(execute([1, 2], doing(len), jobs=2))
    assert isinstance(error, TypeError)
    assert "worker.py" in "".join(error.__notes__)


def test_a_task_that_cannot_be_sent_is_named():
    tasks = [2, 4, threading.Lock(), 6]
    found, error = given(execute(tasks, doing(halved), jobs=2, what="trace"))
    assert found == [1, 2]
    assert isinstance(error, RvmonError)
    assert "trace 3 cannot be given to another process" in str(error)
    assert "use one process (jobs)" in str(error)


@pytest.mark.parametrize("jobs", [2, 5])
def test_a_worker_that_is_lost_is_told_with_its_task(jobs):
    found, error = given(execute([*range(0, 200, 2), 13, 8], doing(halved), jobs=jobs, what="run"))
    assert found == [*range(100)]
    assert isinstance(error, WorkerLostError)
    assert "the process that had run 101 was killed from outside" in str(error)
    assert "memory runs out: use fewer processes (jobs)" in str(error)


def test_a_worker_that_is_lost_while_it_waits_is_replaced():
    """No task is to blame, for example if memory runs out while results are consumed slowly."""
    instead = {"instead": lambda _, ended: ended.why}
    results = execute(range(0, 2000, 2), doing(halved), jobs=1, **instead)
    found = [next(results)]
    (worker,) = multiprocessing.active_children()
    time.sleep(0.5)
    worker.kill()
    worker.join()
    assert [*found, *results] == [*range(1000)]


def test_tasks_without_end_are_taken_as_they_are_needed():
    done = execute(count(), doing(str), jobs=2)
    assert [*islice(done, 100)] == [*map(str, range(100))]
    done.close()
    assert next(done, None) is None


def test_two_executions_at_a_time_do_not_disturb_each_other():
    one, other = (execute(range(50), doing(str), jobs=2) for _ in range(2))
    pairs = [*islice(zip(one, other, strict=True), 20)]
    one.close()
    assert pairs == [(str(k), str(k)) for k in range(20)]
    assert [*other] == [str(k) for k in range(20, 50)]


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
@pytest.mark.parametrize("kind", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_no_worker_outlives_a_parent_that_is_killed(ends_with_its_parent, method, kind):
    ends_with_its_parent(PARENT, [method], kind)


def test_many_traces_are_judged_alike_by_processes(tmp_path: Path):
    spec = rvmon.loads("spec s\nsignal p : bool\nrequirement R\n  always p\n")
    paths = []
    for number in range(60):
        paths.append(tmp_path / f"{number}.csv")
        paths[-1].write_text(f"t,p\n0,1\n1,{int(number % 7 != 3)}\n")
    alone = [*spec.evaluate_many(paths)]
    assert [*spec.evaluate_many(iter(paths), jobs=3)] == alone
    paths[50].write_text("t,p\n0,maybe\n")
    for jobs in (1, 3):
        found, error = given(spec.evaluate_many(paths, jobs=jobs))
        assert found == alone[:50]
        assert isinstance(error, TraceError)
        assert "50.csv" in str(error)


def told(task, ended):
    """The task and how its process ended, in place of a result."""
    return task, ended.timed_out, ended.why


@pytest.mark.parametrize("jobs", [1, 3])
def test_a_task_whose_process_ends_can_have_a_result(jobs):
    def work(number):
        if number == 20:
            time.sleep(600)
        if number == 40:
            os._exit(3)
        return halved(number)

    tasks = [*range(0, 20, 2), 13, 20, *range(22, 40, 2), 40, 50, 60]
    found = [*execute(tasks, doing(work), jobs=jobs, instead=told, timeout_s=1)]
    assert found == [
        *range(10),
        (13, False, "its process was killed by signal SIGKILL"),
        (20, True, "it took more than 1 s"),
        *range(11, 20),
        (40, False, "its process ended, with exit code 3"),
        25,
        30,
    ]


def test_an_error_ends_the_work(tmp_path):
    """A task that raises ends the work, whatever replaces results of lost processes."""
    found, error = given(execute([2, 7, 8], doing(halved), jobs=2, instead=told))
    assert found == [1]
    assert isinstance(error, TraceError)


def test_to_begin_takes_no_time_of_a_task(tmp_path):
    def begin():
        time.sleep(0.6)
        return str

    found = [*execute([1, 2], begin, jobs=1, instead=told, timeout_s=0.5)]
    assert found == ["1", "2"]


def test_the_first_task_has_the_same_time_limit(monkeypatch):
    """The time to start a process is not added to it."""
    monkeypatch.setattr(parallel, "START_S", 3600)
    tasks = execute([600, 0], doing(time.sleep), jobs=1, instead=told, timeout_s=0.5)
    assert [*tasks] == [(600, True, "it took more than 0.5 s"), None]


def test_a_report_is_sent_without_the_plan(tmp_path):
    """The data sent between processes grows with the attempts, not with the specification."""
    many = "".join(f"requirement N{n}\n  always x < {n + 10}\n" for n in range(200))
    spec = rvmon.loads("spec s\nsignal x : real\nrequirement R\n  always x < 3\n" + many)
    report, other = (spec.evaluate([(0, {"x": 1.0}), (1, {"x": 5.0})]) for _ in range(2))
    handed = pickle.dumps(give_plan(other, None))
    assert len(handed) < len(pickle.dumps(report)) / 2
    again = give_plan(pickle.loads(handed), spec.planned())  # noqa: S301 - just made
    assert again == report
    assert again.attempts[0].reason == report.attempts[0].reason
