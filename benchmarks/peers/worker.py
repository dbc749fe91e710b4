"""A peer in a process of its own: one JSON request per line in, one JSON answer per line out.

It runs in the peers' environment and imports nothing of this project.

    python worker.py reelay|rtamt|mstlo|ltlf2dfa

    {"do": "judge", "formula": …, "kind": …, "columns": {name: [value per tick]}}
                                                -> {"values": [verdict or robustness per tick]}
    {"do": "load", "formulas": […], "kind": …, "columns": {…}, "rows": n}  -> {"rows": n}
    {"do": "run"}                               -> {"cpu_ns": …, "violated": [first row or null]}

An error of the peer is an answer, too: {"error": …}. What the peer prints goes to stderr.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
from typing import Any


def main(name: str) -> None:
    """Answer until the input ends."""
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    peer = importlib.import_module(f"with_{name}").Peer()
    for line in sys.stdin:
        request: dict[str, Any] = json.loads(line)
        handler = getattr(peer, request.pop("do"))
        try:
            answer = handler(**request)
        except Exception as error:  # noqa: BLE001 - whatever a peer raises is its answer
            answer = {"error": f"{type(error).__name__}: {error}"[:500]}
        answers.write(json.dumps(answer) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
