"""Tasks on workers of a real Dask scheduler with two processes."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path

import pytest

from rvmon.cli import main
from rvmon.errors import RvmonError, WorkerLostError
from rvmon.execute.parallel import execute

pytestmark = [
    pytest.mark.skipif(find_spec("distributed") is None, reason="needs rvmon[dask]"),
    pytest.mark.process,
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """The address of a scheduler with two workers, which gives up a task that has killed both."""
    folder = tmp_path_factory.mktemp("dask")
    environment = {**os.environ, "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"}
    environment["DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT"] = "1s"
    environment["DASK_DISTRIBUTED__WORKER__MULTIPROCESSING_METHOD"] = "forkserver"  # starts fast
    begun = []

    def begin(*words):
        begun.append(
            subprocess.Popen(  # noqa: S603 - our words
                [sys.executable, "-m", "dask", *words],
                cwd=folder,
                env=environment,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
        )

    try:
        begin(
            *("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"),
            *("--scheduler-file", "where.json"),
        )
        words = ("worker", "--scheduler-file", "where.json", "--no-dashboard")
        begin(*words, "--nthreads", "1", "--nworkers", "2", "--host", "127.0.0.1")
        while True:
            try:
                found = json.loads((folder / "where.json").read_text())["address"]
                break
            except (OSError, ValueError):
                assert begun[0].poll() is None
                time.sleep(0.05)
        yield found
    finally:
        for one in reversed(begun):
            one.terminate()
        for one in begun:
            try:
                one.wait(3)
            except subprocess.TimeoutExpired:
                one.kill()
                one.wait()


def done(begin, tasks, address, **options):
    return list(execute(tasks, begin, jobs=address, **options))


def test_results_come_in_order_from_other_processes(address):
    def begin():
        import os

        made = object()

        def work(task):
            import time

            time.sleep(0.02 * (task % 3))
            return task, os.getpid(), id(made)

        return work

    found = done(begin, range(30), address)
    assert [task for task, *_ in found] == list(range(30))
    assert os.getpid() not in {process for _, process, _ in found}
    assert len({one[1:] for one in found}) == len({process for _, process, _ in found})


def test_an_error_is_raised_in_its_turn(address):
    """After the earlier results; also the error of a task that cannot be created."""

    def begin():
        return lambda task: 12 // task

    results = execute([3, 2, 0, 1], begin, jobs=address)
    assert [next(results), next(results)] == [4, 6]
    with pytest.raises(ZeroDivisionError):
        next(results)

    def tasks():
        yield 3
        raise KeyError("no more")

    results = execute(tasks(), begin, jobs=address)
    assert next(results) == 4
    with pytest.raises(KeyError, match="no more"):
        next(results)


def test_recordings_are_judged_as_here(address, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("s.rv").write_text("signal p : bool\nrequirement R1\n  always p\n")
    for number in range(6):
        Path(f"r{number}.csv").write_text(f"t,p\n0,1\n5,{number % 2}\n")
    words = ["run", "s.rv", *(f"r{number}.csv" for number in range(6)), "--out"]
    assert main([*words, "here.csv"]) == 1
    assert main([*words, "there.csv", "--dask", address]) == 1
    assert Path("there.csv").read_bytes() == Path("here.csv").read_bytes()


def test_a_lost_worker_loses_no_task(address):
    def begin():
        import os
        import time
        from pathlib import Path

        def work(task):
            where, number = task
            Path(where, str(os.getpid())).touch()
            time.sleep(0.1)
            return number

        return work

    with tempfile.TemporaryDirectory() as folder:
        results = execute([(folder, number) for number in range(12)], begin, jobs=address)
        first = next(results)
        os.kill(int(next(iter(os.listdir(folder)))), signal.SIGKILL)
        assert [first, *results] == list(range(12))


@pytest.mark.parametrize("bad", ["kill", "hang"])
def test_a_task_that_ends_its_worker_is_a_result(address, bad):
    def begin():
        import os
        import time

        def work(task):
            if task == "kill":
                os.kill(os.getpid(), 9)
            if task == "hang":
                time.sleep(600)
            return task

        return work

    def instead(task, ended):
        return task, ended.timed_out

    found = done(begin, [1, bad, 2, 3], address, instead=instead, timeout_s=2.0)
    assert found == [1, (bad, bad == "hang"), 2, 3]


def test_without_a_result_in_its_place_it_is_an_error(address):
    def begin():
        import os

        return lambda task: os.kill(os.getpid(), 9) if task else task

    with pytest.raises(WorkerLostError, match="recording 2"):
        done(begin, [0, 1], address, what="recording")


def test_no_scheduler_is_an_error():
    with pytest.raises(RvmonError, match="dask scheduler"):
        done(lambda: abs, [1], "nonsense")
