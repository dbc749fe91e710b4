"""Send requests to a peer that runs in its own process and environment."""

from __future__ import annotations

import json
import subprocess
from contextlib import AbstractContextManager, suppress
from pathlib import Path
from typing import Any

WORKER = Path(__file__).with_name("worker.py")
ADAPTERS = WORKER.with_name("adapters.py")


class PeerError(Exception):
    """The peer refused the request, or its process ended; the text is that of the peer."""


class Peer(AbstractContextManager["Peer"]):
    """A peer's process, restarted when it dies.

    Args:
        python: the interpreter to run it with.
        adapter: the adapter class.
        module: the file of that class.
    """

    def __init__(self, python: Path, adapter: str, module: Path = ADAPTERS) -> None:
        self._command = [str(python), str(WORKER), str(module), adapter]
        self._process: subprocess.Popen[str] | None = None

    def ask(self, do: str, **request: Any) -> dict[str, Any]:
        """Send one request and wait for its answer.

        Raises:
            PeerError: the peer raised, or its process ended.
        """
        process = self._process
        if process is None:
            pipe, nobody = subprocess.PIPE, subprocess.DEVNULL
            process = self._process = subprocess.Popen(
                self._command, stdin=pipe, stdout=pipe, stderr=nobody, text=True
            )
        assert process.stdin is not None
        assert process.stdout is not None
        line = ""
        with suppress(BrokenPipeError):
            process.stdin.write(json.dumps({"do": do, **request}) + "\n")
            process.stdin.flush()
            line = process.stdout.readline()
        if not line:
            self.close()
            raise PeerError(f"its process ended with code {process.returncode}")
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            raise PeerError(answer["error"])
        return answer

    def close(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.communicate()

    def __exit__(self, *_: object) -> None:
        self.close()
