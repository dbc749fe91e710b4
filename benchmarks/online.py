"""Nanoseconds of the processor per sample, a step for each: by form, kind of input and number.

    python -m benchmarks.online [--quick] [--only SECTION …] [--r2u2 FOLDER]
    python -m benchmarks.online --kinds [WORD …] [--rows 4000] [--time sampled] [--unknown 1]

Beside all peers that install, in an environment of their own, made from the package index at first;
and R2U2, of which FOLDER holds a clone. A ratio counts only where verdicts agree. `--kinds` takes
every kind of requirement that people write, published ones, windows of many lengths, ours alone.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from benchmarks.results import ONLINE, parser_of, show
from benchmarks.timing import kinds


def main(argv: Sequence[str]) -> int:
    parser = parser_of(__doc__, ONLINE)
    parser.add_argument("--kinds", nargs="*", metavar="WORD", help="ours alone, by requirement")
    kinds.add_options(parser)
    options = parser.parse_args(argv)
    if options.kinds is not None:
        return kinds.measure(options)
    return show("online", argv, options)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
