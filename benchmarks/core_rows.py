"""Blocks of rows against the samples that they hold, in the core, on random specs and tables.

    python -m benchmarks.core_rows --tables 100000 --rows 400 --seed 1

That rows equal steps is a law: records, counts, times, what is open and what is due have to be the
same behind each block. Prints every table that differs with its seed, and exits with 1 if one does.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections import Counter
from collections.abc import Sequence

from tests.tools.forms import Compiler
from tests.tools.tables import planned_for, random_table, rows_differ

from rvmon.errors import RvmonError
from rvmon.testing.generate.spec import Profile, random_spec

EACH = 20
"""Tables of a specification."""


def main(argv: Sequence[str]) -> int:
    """Judge so many tables, and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--tables", type=int, default=2_000)
    parser.add_argument("--rows", type=int, default=400, help="of a table, at most")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--from", type=int, default=0, dest="first", help="pass over so many specs")
    options = parser.parse_args(argv)
    count: Counter[str] = Counter()
    number = options.first
    while count["tables"] < options.tables:
        judge_spec(f"{options.seed}/{number}", options.rows, count)
        number += 1
    print(", ".join(f"{name} {n}" for name, n in count.items()))
    return 1 if count["differ"] else 0


def judge_spec(seed: str, rows: int, count: Counter[str]) -> None:
    """Judge tables of one random specification."""
    rng = random.Random(f"rows/{seed}")
    spec = random_spec(rng, Profile(crowded=5, many=8, wide=10))
    try:
        planned = planned_for(spec, Compiler())
    except RvmonError:
        count["refused"] += 1
        return
    for each in range(EACH):
        table = random_table(rng, spec, planned.single_payloads, rows)
        found = rows_differ(planned, spec, table)
        count["tables"] += 1
        count["rows"] += len(table.rows)
        count["differ"] += bool(found)
        if found:
            print(f"seed {seed}, table {each}: {found[:400]}", flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
