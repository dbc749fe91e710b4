"""Runs in processes of their own, which have all modules of this one, and can be killed."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from tests.tools.servers import LONG


class Forked:
    """A run of something in a process of its own, at the head of all that it begins.

    Args:
        run: gives the exit code.
        folder: where it runs.
        out: takes its standard output; what it says beside goes to a file of this name with `.err`.

    Attributes:
        code: how it ended, below 0 by which signal; `None`: it has not.
    """

    def __init__(self, run: Callable[[], object], folder: Path, out: Path) -> None:
        self.code: int | None = None
        self._out = out
        out.write_bytes(b"")
        self._pid = os.fork()
        if self._pid == 0:
            self._run(run, folder)

    def _run(self, run: Callable[[], object], folder: Path) -> None:
        code: object = 70
        try:
            os.setsid()
            os.chdir(folder)
            for number, path in ((1, str(self._out)), (2, f"{self._out}.err")):
                os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), number)
            sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
            code = run()
            sys.stdout.flush()
        finally:
            sys.stderr.flush()
            os._exit(code if isinstance(code, int) else 0)

    def kill_behind(self, size: int) -> bool:
        """Kill it when it has told so many bytes; `False`: it ended before."""
        return self.kill_when(lambda: self._out.stat().st_size >= size)

    def lines(self) -> list[str]:
        """What was told, but for a last line in which it was killed."""
        text = self._out.read_text()
        return [line for line in text.splitlines(keepends=True) if line.endswith("\n")]

    def kill_when(self, is_time: Callable[[], bool]) -> bool:
        """Kill it with all that it began as soon as something is true; `False`: it ended before."""
        end = time.monotonic() + 20 * LONG
        while True:
            pid, status = os.waitpid(self._pid, os.WNOHANG)
            if pid:
                self.code = os.waitstatus_to_exitcode(status)
                return False
            is_late = time.monotonic() > end
            if is_late or is_time():
                with suppress(ProcessLookupError):  # it is not at the head of any yet
                    os.killpg(self._pid, signal.SIGKILL)
                os.kill(self._pid, signal.SIGKILL)
                self.code = os.waitstatus_to_exitcode(os.waitpid(self._pid, 0)[1])
                if is_late:
                    raise TimeoutError("it has not come so far")
                return True
            time.sleep(0.001)
