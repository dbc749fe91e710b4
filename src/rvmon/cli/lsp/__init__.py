"""`rvmon lsp`: the language server that editors start."""

from __future__ import annotations

import argparse
import os
import signal
import sys

from rvmon.errors import needed


def run_lsp(arguments: argparse.Namespace) -> int:  # noqa: ARG001 - it has one way to serve
    """Serve until the editor ends the session, and return the exit code."""
    with needed("the language server", "pygls"):
        from rvmon.cli.lsp.server import Server
    # End at once by signals: while the loop waits for the editor, Python's handlers may not run.
    for ending in (signal.SIGINT, signal.SIGTERM):
        signal.signal(ending, signal.SIG_DFL)
    # Only the protocol may use standard output; all other output goes to standard error, the log.
    with os.fdopen(os.dup(1), "wb") as answers:
        os.dup2(2, 1)
        Server().start_io(sys.stdin.buffer, answers)
    return 0
