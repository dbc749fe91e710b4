"""How cost grows: with the work, on streams that are hard, on inputs that are large or endless.

    python -m benchmarks.growth cliffs [--rows 20000]
    python -m benchmarks.growth large [--only WORD] [--limit SECONDS]
    python -m benchmarks.growth scale --recordings 10000 --requirements 10000 --tests 1000
    python -m benchmarks.growth coverage [--tests 10000] [--items 1000] [--share 0.2]
    python -m benchmarks.growth automata --formulas 600 --depth 3

`cliffs` has streams beside their quiet neighbours. `large` has inputs that are wide, long, or all
decided at once; a process that needs longer than the limit is stopped, and none may take more than
6 GiB. `scale` multiplies the number of recordings, requirements and tests by ten, up
to those given: what one of them costs more than at a tenth of them. `coverage` records tests that
hit a random share of the items, with random counts and instants (real ones repeat, and take less
room), and looks at the database. `automata` draws formulas with so many temporal operators nested:
how many close, how large they get, how long they take; it fails if one takes more than `--most`
seconds.

Processes are told with seconds of the clock and of CPU (with those of all processes that they
began), largest resident memory, exit code, and the last line that was said.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from benchmarks.growth import automata, cliffs, large, scale


def main(argv: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("what", choices=("cliffs", "large", "scale", "coverage", "automata"))
    parser.add_argument("--rows", type=int, default=20_000, help="cliffs: of a stream")
    parser.add_argument("--repeats", type=int, default=5, help="cliffs: passes")
    parser.add_argument("--only", default="", help="large: inputs whose name holds this word")
    parser.add_argument("--limit", type=float, default=600.0, help="seconds for one process")
    parser.add_argument("--recordings", type=int, default=10_000)
    parser.add_argument("--requirements", type=int, default=1_000)
    parser.add_argument("--tests", type=int, default=100)
    parser.add_argument("--items", type=int, default=1_000)
    parser.add_argument("--share", type=float, default=0.2)
    parser.add_argument("--formulas", type=int, default=600)
    parser.add_argument("--depth", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--most", type=float, default=2.0, help="automata: seconds for one formula")
    options = parser.parse_args(argv)
    if options.what == "automata":
        return automata.measure(options)
    if options.what == "cliffs":
        for line in cliffs.lines(options.rows, options.repeats):
            print(line, flush=True)
        return 0
    print(f"{'':44}{'s':>8}{'CPU s':>8}{'MiB':>8}{'exit':>6}")
    {"large": large.large, "scale": scale.scale, "coverage": scale.coverage}[options.what](options)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
