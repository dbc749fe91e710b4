"""How cost grows: with the work, with open attempts, on streams that are hard.

    python -m benchmarks.growth cliffs [--rows 20000]
    python -m benchmarks.growth scale --recordings 10000 --requirements 10000 --tests 1000
    python -m benchmarks.growth coverage [--tests 10000] [--items 1000] [--share 0.2]
    python -m benchmarks.growth automata --formulas 600 --depth 3

`cliffs` has streams beside their quiet neighbours. `scale` multiplies the number of recordings,
requirements and tests by ten, up to those given: what one of them costs more than at a tenth of
them. `coverage` records tests that hit a random share of the items, with random counts and instants
(real ones repeat, and take less room), and looks at the database. `automata` draws formulas with so
many temporal operators nested, every other required from the start, the others `whenever p`: how
many close, how large they get before and after they are reduced, how long that takes; it fails if
one takes more than `--most` seconds of CPU.

Processes are told with seconds of the clock and of CPU (with those of all processes that they
began), largest resident memory, exit code, and the last line that was said; one that needs longer
than `--limit` seconds is stopped, and none may take more than 6 GiB.
"""

from __future__ import annotations

import sys

from benchmarks.growth.automata import automata
from benchmarks.growth.cliffs import cliffs
from benchmarks.growth.scale import coverage, scale
from benchmarks.program import program

if __name__ == "__main__":
    sys.exit(program(__doc__, cliffs, scale, coverage, automata))
