"""What other monitors say of the same formulas, and of the same faults.

    python -m benchmarks.peers differences
    python -m benchmarks.peers faults

`differences` runs every row of the table of readings on both sides: a peer that answers otherwise
than written has changed. `faults` puts damaged streams to all, sample by sample. Random formulas
are those of `benchmarks.differential peers peers-robustness`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from benchmarks.peers import differences, faults
from benchmarks.peers.environment import prepare


def main(argv: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("what", choices=("differences", "faults"))
    if parser.parse_args(argv).what == "faults":
        faults.tables(prepare())
    else:
        print("\n".join(differences.lines(prepare())))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
