"""A program ends with the process that started it; interrupts clean up."""

import os
import signal
import subprocess

import pytest

from rvmon.execute import run_command

pytestmark = pytest.mark.skipif(os.name != "posix", reason="needs the signals of POSIX")

COMMAND = """
import sys
from rvmon.execute import run_command
from rvmon.execute import interrupted_by_sigterm

with interrupted_by_sigterm():
    words = ["sh", "-c", "sleep 600 & echo $! $$; wait"]
    run_command(words, stdout=sys.stdout, capture_output=False)
"""


@pytest.mark.process
@pytest.mark.parametrize("kind", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_nothing_outlives_a_parent_that_is_killed(ends_with_its_parent, kind):
    ends_with_its_parent(COMMAND, [], kind)


def test_a_command_says_how_it_ended():
    done = run_command(["sh", "-c", "cat; echo said; echo more >&2; exit 7"])
    assert (done.returncode, done.stdout, done.stderr) == (7, "said\n", "more\n")


@pytest.mark.slow
def test_a_command_that_takes_too_long_is_ended(tmp_path, all_have_ended):
    told = tmp_path / "told"
    with pytest.raises(subprocess.TimeoutExpired):
        run_command(["sh", "-c", f"sleep 600 & echo $! > {told}; wait"], timeout=1)
    all_have_ended([int(told.read_text())])
