"""Random runs through every door, each of which loses something: is a green verdict overturned?

    python -m benchmarks.lost --runs 5000 --only mqtt stdin

Prints by door how many runs were judged, refused, and turned by some filling of what was lost; each
run whose verdict a filling overturns by its name, and exits with 1 if there is one. In each run
what is lost changes a letter that a requirement reads. Doors whose server is not installed are
said to be left out.
"""

from __future__ import annotations

import argparse
import logging
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from tests.tools.lossy.doors import DOORS, SERVERS
from tests.tools.lossy.trial import FILLINGS, outcomes


def main(argv: Sequence[str]) -> int:
    """Try the doors, and print the figures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=5_000, help="through each door")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=DOORS, nargs="+", default=[*DOORS], metavar="DOOR")
    options = parser.parse_args(argv)
    logging.disable(logging.ERROR)
    bad = 0
    for door in options.only:
        program, found = SERVERS.get(door, ("", str))
        if found() is None:
            print(f"{door}: left out, as {program} is not installed")
            continue
        with tempfile.TemporaryDirectory() as folder:
            bad += tried(door, options.runs, options.seed, Path(folder))
    return int(bad > 0)


def tried(door: str, runs: int, seed: int, folder: Path) -> int:
    """Try one door; so many verdicts are overturned."""
    began = time.monotonic()
    made = refused = split = bad = 0
    for one in outcomes(door, DOORS[door], runs, seed, folder):
        made += 1
        refused += one.is_refused
        split += one.is_split
        bad += bool(one.overturned)
        if one.overturned:
            print(f"{door}: {one.name} overturns {', '.join(one.overturned)}", flush=True)
    print(
        f"{door}: {made:,} runs of {FILLINGS} fillings, letters changed in all, refused "
        f"{refused:,}, turned by a filling {split:,} ({split / made:.1%}), overturned {bad}, "
        f"{time.monotonic() - began:.0f} s",
        flush=True,
    )
    return bad


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
