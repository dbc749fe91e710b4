"""A monitor that lives long, and processes that are killed.

python -m benchmarks.endurance soak --samples 100000000 [--exported]
python -m benchmarks.endurance kills --kills 50 [--only KIND …]
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from benchmarks.endurance import kills, soak

WHAT = {"soak": soak.main, "kills": kills.main}


def main(argv: Sequence[str]) -> int:
    if argv and argv[0] in WHAT:
        return WHAT[argv[0]](argv[1:])
    print(__doc__)
    return 0 if argv and argv[0] in ("-h", "--help") else 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
