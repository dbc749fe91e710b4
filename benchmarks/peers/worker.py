"""Run a peer in a separate process: one JSON request per line in, one JSON answer per line out.

    python worker.py MODULE.py CLASS

It imports nothing of this package, because it may run in the environment of the peer. A request
names a method of the class and its arguments. An error of the peer is an answer, too:
{"error": …}. Output of the peer goes to stderr.
"""

from __future__ import annotations

import json
import os
import runpy
import sys
from typing import Any


def main(path: str, name: str) -> None:
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    sys.path.pop(0)  # this folder: peers must not import its modules
    peer = runpy.run_path(path)[name]()
    for line in sys.stdin:
        request: dict[str, Any] = json.loads(line)
        handler = getattr(peer, request.pop("do"))
        try:
            answer = handler(**request)
        except Exception as error:  # noqa: BLE001 - whatever a peer raises is its answer
            answer = {"error": f"{type(error).__name__}: {error}"[:500]}
        answers.write(json.dumps(answer) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
