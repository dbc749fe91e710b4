"""What other monitors say of the same formulas, and of the same faults.

    python -m benchmarks.peers differences
    python -m benchmarks.peers faults

`differences` runs every row of the table of readings on both sides: a peer that answers otherwise
than written has changed. `faults` puts damaged streams to all, sample by sample. Random formulas
are those of `benchmarks.differential peers peers-robustness`.
"""

from __future__ import annotations

import sys

from benchmarks.peers.differences import differences
from benchmarks.peers.faults import faults
from benchmarks.program import program

if __name__ == "__main__":
    sys.exit(program(__doc__, differences, faults))
