"""What a program costs, in a process of its own."""

from __future__ import annotations

import ctypes
import os
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


_PARENT_DEATH_SIGNAL = 1
"""`PR_SET_PDEATHSIG` of Linux."""


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
    """Run a program, at most so many seconds, in at most so many bytes.

    It ends with who began it, however that ends; what it has begun itself, and nobody ends, when it
    has computed as long as all cores could have in that time.
    """
    parent, library = os.getpid(), ctypes.CDLL(None)
    cpu = int(limit * (os.cpu_count() or 1)) + 1

    def bounded() -> None:
        library.prctl(_PARENT_DEATH_SIGNAL, signal.SIGKILL)
        if os.getppid() != parent:  # it has ended before it was asked for
            os._exit(1)
        resource.setrlimit(resource.RLIMIT_CPU, (cpu, cpu))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if memory is not None:
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))

    began = time.monotonic()
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=errors,
            env=environment,
            cwd=folder,
            preexec_fn=bounded,
            start_new_session=True,
        )
        ended, peak = 0, 0.0
        while not ended:
            peak = max(peak, _mebibytes(process.pid))
            if time.monotonic() > began + limit:
                os.killpg(process.pid, signal.SIGKILL)
            time.sleep(POLL_S)
            ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        seconds = time.monotonic() - began
        process.returncode = os.waitstatus_to_exitcode(status)
        texts = []
        for file in (output, errors):
            file.seek(0)
            texts.append(file.read().decode(errors="replace"))
    return Cost(seconds, usage.ru_utime + usage.ru_stime, peak, process.returncode, *texts)


def _mebibytes(pid: int) -> float:
    """The largest resident memory of a process since it began; 0 if it has ended."""
    with suppress(OSError):
        for line in Path(f"/proc/{pid}/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) / 1024
    return 0.0
