"""What random coverpoints and crosses are hit on random traces, against the definition.

    python -m benchmarks.coverage_differential --pairs 10000 [--seed N]

Prints every disagreement with its seed, then the figures; exits with 1 if there is one.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Sequence

from tests.tools.coverage import judge


def main(argv: Sequence[str]) -> int:
    """Run and print the figures."""
    parser = argparse.ArgumentParser(description="Coverage against its definition.")
    parser.add_argument("--pairs", type=int, default=10_000)
    parser.add_argument("--each", type=int, default=10, help="traces per specification")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(argv)
    tally: Counter[str] = Counter()
    wrong = 0
    number = 0
    while tally["pairs"] < options.pairs:
        for text in judge(f"{options.seed}/{number}", options.each, tally):
            wrong += 1
            print(text, flush=True)
        number += 1
    print(f"pairs {tally['pairs']}, hits {tally['hits']}, disagreements {wrong}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
