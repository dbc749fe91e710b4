"""Nanoseconds of the processor per sample, a step for each: by form, kind of input and number.

    python -m benchmarks.online [--quick] [--only SECTION …] [--r2u2 FOLDER]

Beside all peers that install, in an environment of their own, made from the package index at first;
and R2U2, of which FOLDER holds a clone. A ratio counts only where verdicts agree.
"""

from __future__ import annotations

import sys
from functools import partial

from benchmarks.program import program
from benchmarks.results import ONLINE, main

if __name__ == "__main__":
    sys.exit(program(__doc__, partial(main, only=ONLINE, out=None)))
