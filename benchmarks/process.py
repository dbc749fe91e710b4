"""Run a program in a separate process and measure its cost."""

from __future__ import annotations

import os
import re
import resource
import signal
import subprocess
import tempfile
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

POLL_S = 0.005
"""Seconds between two polls of a process. The measured cost includes starting it."""


class Cost(NamedTuple):
    """The cost of a process, and how it ended."""

    seconds: float  # wall-clock time
    cpu: float  # seconds, including those of the processes it started and waited for
    mebibytes: float  # the largest resident memory of the first process seen in polls
    code: int  # the exit code; negative: the signal that killed it
    output: str
    errors: str

    @property
    def said(self) -> str:
        """The last line of its errors, or of its output if there are no errors."""
        lines = (self.errors.strip() or self.output.strip()).splitlines()
        return lines[-1] if lines else ""


def measured(
    command: Sequence[str],
    limit: float = 3600.0,
    *,
    memory: int | None = None,
    environment: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> Cost:
    """Run a program for at most `limit` seconds in `memory` bytes; an interrupt kills it."""
    began, ended, peak = time.monotonic(), 0, 0.0
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=errors,
            env=environment,
            cwd=folder,
            start_new_session=True,
        )
        try:
            if memory is not None:
                resource.prlimit(process.pid, resource.RLIMIT_AS, (memory, memory))
            while not ended:
                peak = max(peak, mebibytes(process.pid, "VmHWM"))
                if time.monotonic() > began + limit:
                    os.killpg(process.pid, signal.SIGKILL)
                time.sleep(POLL_S)
                ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        finally:
            if not ended:
                os.killpg(process.pid, signal.SIGKILL)
        seconds = time.monotonic() - began
        process.returncode = os.waitstatus_to_exitcode(status)
        texts = []
        for file in (output, errors):
            file.seek(0)
            texts.append(file.read().decode(errors="replace"))
    return Cost(seconds, usage.ru_utime + usage.ru_stime, peak, process.returncode, *texts)


def mebibytes(pid: int | str, which: str) -> float:
    """A memory figure of a process from `/proc`, such as `VmRSS`; 0 if the process has ended."""
    with suppress(OSError):
        found = re.search(rf"{which}:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text())
        return int(found[1]) / 1024 if found else 0.0
    return 0.0
