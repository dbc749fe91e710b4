"""Processes that others began end with them; interrupts clean up."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import rvmon
from rvmon.children import run
from rvmon.errors import WorkerLostError

pytestmark = [
    pytest.mark.process,
    pytest.mark.skipif(os.name != "posix", reason="needs the signals of POSIX"),
]

WORKERS = """
import os, sys, time
from rvmon.children import interrupted_by_sigterm, workers

if __name__ == "__main__":
    with interrupted_by_sigterm(), workers(2, sys.argv[1]) as pool:
        print(*{pool.submit(os.getpid).result(60) for _ in range(9)}, flush=True)
        list(pool.map(time.sleep, [600, 600, 600]))
"""

COMMAND = """
import sys
from rvmon.children import interrupted_by_sigterm, run

with interrupted_by_sigterm():
    run(["sh", "-c", "sleep 600 & echo $! $$; wait"], stdout=sys.stdout, capture_output=False)
"""


def has_ended(process: int) -> bool:
    """Whether a process is gone, or waits for someone to ask how it ended."""
    try:
        os.kill(process, 0)
        stat = Path(f"/proc/{process}/stat")
        return stat.exists() and stat.read_text().rpartition(")")[2].split()[0] == "Z"
    except (ProcessLookupError, FileNotFoundError):
        return True


@pytest.mark.parametrize("kind", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize(
    ("text", "words"),
    [(WORKERS, ["fork"]), (WORKERS, ["spawn"]), (WORKERS, ["forkserver"]), (COMMAND, [])],
    ids=["fork", "spawn", "forkserver", "command"],
)
def test_nothing_outlives_a_parent_that_is_killed(tmp_path, text, words, kind):
    """However it ends; also what was begun by those that it began."""
    script = tmp_path / "parent.py"
    script.write_text(text)
    with subprocess.Popen(  # noqa: S603 - our words
        [sys.executable, str(script), *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    ) as parent:
        assert parent.stdout is not None
        children = [int(word) for word in parent.stdout.readline().split()]
        assert children
        parent.send_signal(kind)
        code = parent.wait()
    assert code == -(signal.SIGKILL if kind is signal.SIGKILL else signal.SIGINT)
    while not all(map(has_ended, children)):  # or the test does not end
        time.sleep(0.02)


def test_a_command_says_how_it_ended():
    """Its exit code and what it said; it has no standard input."""
    done = run(["sh", "-c", "cat; echo said; echo more >&2; exit 7"])
    assert (done.returncode, done.stdout, done.stderr) == (7, "said\n", "more\n")


def test_a_command_that_takes_too_long_is_ended(tmp_path):
    """With all that it began."""
    told = tmp_path / "told"
    with pytest.raises(subprocess.TimeoutExpired):
        run(["sh", "-c", f"sleep 600 & echo $! > {told}; wait"], timeout=1)
    while not has_ended(int(told.read_text())):
        time.sleep(0.02)


class Deadly:
    """What kills the process that receives it."""

    def __reduce__(self):
        return die, ()


def die():
    """End as the system ends a process when memory runs out."""
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_worker_that_is_killed_is_told():
    """What was judged before has been given out; the error says the cause and a mend."""
    spec = rvmon.loads("spec s\nsignal p : bool\nrequirement R\n  always p\n")
    with pytest.raises(WorkerLostError, match=r"memory runs out: use fewer processes \(jobs\)"):
        list(spec.evaluate_many([[(0, {"p": True})], Deadly(), Deadly()], jobs=2))
