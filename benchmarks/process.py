"""What a program costs, in a process of its own."""

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
"""Between two looks at a process; what it is told to have used includes who began it."""


class Cost(NamedTuple):
    """What a process cost, and how it ended."""

    seconds: float  # by the clock
    cpu: float  # seconds, with those of all processes that it began and waited for
    mebibytes: float  # the largest resident memory of the first process, as far as it was seen
    code: int  # how it ended, below 0 by which signal
    output: str
    errors: str

    @property
    def said(self) -> str:
        """The last line that it said, if need be among what it printed."""
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
    """Run a program, at most so many seconds, in at most so many bytes; it ends with this one."""
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
    """A figure of Linux on the memory of a process; 0 if it has ended."""
    with suppress(OSError):
        found = re.search(rf"{which}:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text())
        return int(found[1]) / 1024 if found else 0.0
    return 0.0
