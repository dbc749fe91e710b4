"""`rvmon lsp`: the language server that editors start."""

from __future__ import annotations

import argparse
import os
import signal
import sys

from rvmon.errors import needed


def run_lsp(arguments: argparse.Namespace) -> int:  # noqa: ARG001 - it has one way to serve
    """Serve until the editor ends it, and return the exit code."""
    with needed("the language server", "pygls"):
        from rvmon.cli.lsp.server import Server
    for ending in (signal.SIGINT, signal.SIGTERM):  # at once: a thread waits for the editor
        signal.signal(ending, lambda *_: os._exit(130))
    # Standard output is the protocol's alone: what anything else prints there goes to the log.
    with os.fdopen(os.dup(1), "wb") as answers:
        os.dup2(2, 1)
        Server().start_io(sys.stdin.buffer, answers)
    return 0
