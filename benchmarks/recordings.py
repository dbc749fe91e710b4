"""Recordings from the file to the verdict: columns, whole processes, large, many and odd files.

    python -m benchmarks.recordings [--quick] [--only batch process files]

Columns in memory and whole processes judge families of formulas beside reelay, whose C++ is built
where g++ and Boost are, 10^5 rows beside 10^6. Files are a robot's: one large beside DuckDB, the
same as other programs write it, one of twice as many rows for the memory, many at once, a tiny one.
Ratios are of the first of a group over the one, and stand only where both find the same failures.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from benchmarks.results import RECORDINGS, parser_of, show


def main(argv: Sequence[str]) -> int:
    return show("recordings", argv, parser_of(__doc__, RECORDINGS).parse_args(argv))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
