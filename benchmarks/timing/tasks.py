"""Programs that judge files, in turn, each in a process of its own."""

from __future__ import annotations

import os
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

POLL_S = 0.005
"""Between two looks at a process; what it is told to have used includes who began it."""


@dataclass(slots=True)
class Task:
    """A way to judge some files.

    Attributes:
        what: is judged.
        who: judges.
        command: exits 0 or 1.
        read: what was found, from what it prints; `None`: that is not looked at.
        rows: of all files.
        wall: seconds of each pass.
        cpu: the same.
        mebibytes: the largest resident memory of the first process, as far as it was seen.
        found: in the last pass.
        refusal: why it was not measured.
    """

    what: str
    who: str
    command: Sequence[str]
    read: Callable[[str], object] | None
    rows: int = 1
    wall: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)
    mebibytes: float = 0
    found: object = None
    refusal: str = ""

    def run(self, installed: Mapping[str, str], *, counts: bool) -> None:
        """Judge once, in an environment; one that cannot notes its refusal."""
        began = time.monotonic()
        with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as told:
            process = subprocess.Popen(self.command, stdout=said, stderr=told, env=installed)
            ended, peak = 0, 0.0
            while not ended:
                peak = max(peak, _mebibytes(process.pid))
                time.sleep(POLL_S)
                ended, status, usage = os.wait4(process.pid, os.WNOHANG)
            wall = time.monotonic() - began
            process.returncode = os.waitstatus_to_exitcode(status)
            if process.returncode not in (0, 1):
                told.seek(0)
                lines = told.read().decode(errors="replace").strip().splitlines()
                self.refusal = lines[-1] if lines else f"exit code {process.returncode}"
                return
            said.seek(0)
            printed = said.read().decode()
        if counts:
            self.wall.append(wall)
            self.cpu.append(usage.ru_utime + usage.ru_stime)
            self.mebibytes = max(self.mebibytes, peak)
        if self.read is not None:
            self.found = self.read(printed)


def _mebibytes(pid: int) -> float:
    """The largest resident memory of a process since it began; 0 if it has ended."""
    with suppress(OSError):
        for line in Path(f"/proc/{pid}/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) / 1024
    return 0.0


def measure(tasks: Sequence[Task], repeats: int, installed: Mapping[str, str]) -> None:
    """So many passes of all tasks in turn, behind a first one that fills caches if several."""
    for number in range(-1 if repeats > 1 else 0, repeats):
        for task in tasks:
            if not task.refusal:
                task.run(installed, counts=number >= 0)


def as_installed(folder: Path) -> dict[str, str]:
    """The environment in which Python keeps what it has compiled, as an installed package is."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return {**kept, "PYTHONPYCACHEPREFIX": str(folder / "compiled")}
