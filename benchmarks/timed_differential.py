"""The model checker against the region graph on random networks.

    python -m benchmarks.timed_differential --networks 5000

Prints the number of networks, of queries by kind and answer, of runs that were checked as concrete
runs, and of disagreements, which must be none.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter

from tests.tools.timed_generate import random_model
from tests.tools.timed_regions import TooManyRegionsError, decide
from tests.tools.timed_runs import shows

from rvmon.timed.language.load import loads_network
from rvmon.timed.search.outcome import Policy
from rvmon.timed.search.verify import verify

KINDS = (
    "E<> p", "A[] p", "A<> p", "E[] p", "p --> q", "p -->[<=T] q", "E<>[<=T] p", "A<>[<=T] p",
    "E<> deadlock", "A[] (deadlock imply p)", "A[] (p imply EF q)", "E<> (p and AG q)",
    "A[] (p or AF q)", "E<>[<=T] deadlock",
)  # fmt: skip
"""The queries of a random network, in order."""

SAY_EVERY = 250
"""Networks between two lines on standard error."""


def main() -> int:
    """Compare, print, and return 1 if anything disagreed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--networks", type=int, default=5_000)
    parser.add_argument("--first", type=int, default=0, help="seed of the first network")
    parser.add_argument("--regions", type=int, default=1_500, help="most regions to walk through")
    arguments = parser.parse_args()
    answers: Counter[tuple[str, bool]] = Counter()
    skipped = runs = disagreements = 0
    began = time.perf_counter()
    for seed in range(arguments.first, arguments.first + arguments.networks):
        network = loads_network(random_model(seed), name=f"random-{seed}")
        policy = tuple(Policy)[seed % 3]
        for kind, query in zip(KINDS, network.queries, strict=True):
            outcome = verify(network, query, policy=policy)
            if outcome.run is not None:
                runs += 1
                if not shows(network, outcome):
                    disagreements += 1
                    print(f"seed {seed}: the run does not show that {query.text}: {outcome.holds}")
            try:
                expected = decide(network, query, arguments.regions)
            except TooManyRegionsError:
                skipped += 1
                continue
            answers[kind, expected] += 1
            if outcome.holds != expected:
                disagreements += 1
                print(f"seed {seed}: {query.text}: zones {outcome.holds}, regions {expected}")
        done = seed - arguments.first + 1
        if done % SAY_EVERY == 0:
            told = f"{done} networks, {disagreements} disagreements so far"
            print(told, file=sys.stderr, flush=True)
    print(f"{arguments.networks} networks, {time.perf_counter() - began:.0f} s")
    for kind in KINDS:
        print(f"  {kind:24} true {answers[kind, True]:6}   false {answers[kind, False]:6}")
    print(f"{skipped} queries skipped for too many regions")
    print(f"{runs} runs checked as concrete runs")
    print(f"{disagreements} disagreements")
    return int(disagreements > 0)


if __name__ == "__main__":
    raise SystemExit(main())
