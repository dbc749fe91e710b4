"""Helpers that observe processes."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest


def has_ended(process: int) -> bool:
    """Whether a process has ended (it may be a zombie)."""
    try:
        os.kill(process, 0)
        stat = Path(f"/proc/{process}/stat")
        return stat.exists() and stat.read_text().rpartition(")")[2].split()[0] == "Z"
    except (ProcessLookupError, FileNotFoundError):
        return True


@pytest.fixture
def all_have_ended():
    """Waits until processes have ended."""

    def wait(processes: list[int]) -> None:
        while not all(map(has_ended, processes)):
            time.sleep(0.02)

    return wait


@pytest.fixture
def ends_with_its_parent(tmp_path, all_have_ended):
    """Kills a script that prints the processes it has started, and waits until these have ended."""

    def check(text: str, words: list[str], kind: signal.Signals) -> None:
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
        all_have_ended(children)

    return check
