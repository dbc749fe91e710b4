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
    # At once: while the loop waits for the editor, a handler of Python's may not get to run.
    for ending in (signal.SIGINT, signal.SIGTERM):
        signal.signal(ending, signal.SIG_DFL)
    # Standard output is the protocol's alone: what anything else prints there goes to the log.
    with os.fdopen(os.dup(1), "wb") as answers:
        os.dup2(2, 1)
        Server().start_io(sys.stdin.buffer, answers)
    return 0
