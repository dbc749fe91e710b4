"""Recordings from the file to the verdict: columns, whole processes, large, many and odd files.

    python -m benchmarks.recordings [--quick] [--only batch files]

Columns in memory judge families of formulas beside reelay, whose C++ is built where g++ and Boost
are, 10^5 rows beside 10^6; so do whole processes. Other files are a robot's: one large beside
DuckDB, the same as other programs write it, one of twice as many rows for the memory, many at once,
a tiny one.
Ratios are of the first of a group over the one, and stand only where both find the same failures.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.program import program
from benchmarks.results import RECORDINGS
from benchmarks.results import main as measured


def main(*, quick: bool = False, only: Sequence[str] = RECORDINGS, out: Path | None = None) -> None:
    """Files and columns; `--quick` takes a few minutes."""
    measured(quick=quick, only=only, out=out)


if __name__ == "__main__":
    sys.exit(program(__doc__, main))
