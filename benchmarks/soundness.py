r"""Green never hides a failure: what was lost is filled in, and no verdict may turn.

    python -m benchmarks.soundness --runs 20000 --fillings 8 --seed 1 --workers 2

A run's P or NT that becomes F, or its F that becomes anything else, is printed; exits 1 if there is
one.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections import Counter
from collections.abc import Iterable
from functools import partial

from tests.tools.differential import case_of
from tests.tools.sound import is_spoken_of, overturned

from rvmon.execute.parallel import execute
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.testing.show import show_case


def run_part(options: argparse.Namespace, seeds: Iterable[str]) -> tuple[Counter[str], list[str]]:
    """Try the cases of some seeds; runs in a worker."""
    verdicts: Counter[str] = Counter()
    found: list[str] = []
    for seed in seeds:
        case = case_of(seed, Profile(requirements=1), TraceProfile())
        if not is_spoken_of(case.spec):
            continue
        rng = random.Random(seed)
        before, overturning = overturned(rng, case, options.fillings)
        verdicts.update(verdict.value for verdict in before.values())
        if overturning is not None:
            lines = [f"seed {seed}", show_case(case), "filled in:", show_case(overturning)]
            found.append("\n".join(lines))
    return verdicts, found


def main(argv: list[str]) -> int:
    """Run the campaign and print its figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--runs", type=int, default=1_000)
    parser.add_argument("--fillings", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args(argv)
    seeds = [f"{options.seed}/{number}" for number in range(options.runs)]
    parts = [seeds[start : start + 50] for start in range(0, len(seeds), 50)]
    verdicts: Counter[str] = Counter()
    found: list[str] = []
    begin = partial(partial, run_part, options)
    for counted, overturning in execute(parts, begin, jobs=options.workers, what="part"):
        verdicts += counted
        found += overturning
    shown = ", ".join(f"{name} {n}" for name, n in sorted(verdicts.items()))
    total = verdicts.total()
    print(f"runs {total} (of {options.runs}; the others ask what is known), {shown}")
    print(f"{options.fillings} fillings each, overturned {len(found)}")
    for text in found[:3]:
        print("\n" + "=" * 72 + "\n" + text)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
