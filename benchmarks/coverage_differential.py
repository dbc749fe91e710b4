"""What random coverpoints and crosses are hit on random traces, against the definition.

    python -m benchmarks.coverage_differential --pairs 10000 [--seed N]

Prints every disagreement with its seed, then the figures; exits with 1 if there is one.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections import Counter
from collections.abc import Sequence

from rvmon.coverage.monitor import CoverageMonitor
from rvmon.coverage.of_spec import combination_name
from rvmon.coverage.watcher import Bins
from rvmon.testing.case import Case
from rvmon.testing.generate.coverage import with_random_coverage
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile, random_trace
from rvmon.testing.law.coverage import hits_on
from rvmon.testing.law.sample_words import word_of
from rvmon.trace.sample import Sample

Counted = dict[str, dict[str, tuple[int, int | None]]]


def by_law(case: Case) -> Counted:
    """What the definition says, as `by_monitor` tells it."""
    word = word_of(case.spec, case.samples, end=case.end, advances=case.advances, names=case.names)
    return {
        name: {combination_name(bins): found for bins, found in own.items()}
        for name, own in hits_on(case.spec, word).items()
    }


def by_monitor(case: Case, bins: Bins) -> Counted:
    """What a monitor finds: how often, and when first."""
    monitor = CoverageMonitor(bins, sources=case.names)
    for one in case.actions:
        if isinstance(one, Sample):
            monitor.step_ns(one.t, one.values)
        else:
            monitor.advance_ns(one)
    hits = monitor.finish_ns(case.end)
    return {
        name: {item: (hit.count, hit.first) for item, hit in own.items()}
        for name, own in hits.items()
    }


def judge(seed: str, each: int, tally: Counter[str]) -> list[str]:
    """Compare on the traces of one specification; returns what differs."""
    rng = random.Random(seed)
    spec = with_random_coverage(rng, Profile(requirements=1, captures=False, for_each=False))
    bins = Bins(spec)
    wrong = []
    for place in range(each):
        case = random_trace(rng, spec, TraceProfile(long=10))
        law, found = by_law(case), by_monitor(case, bins)
        tally["pairs"] += 1
        tally["hits"] += sum(count for own in law.values() for count, _ in own.values())
        if law != found:
            wrong.append(f"{seed}, trace {place}: law {law}, monitor {found}")
    return wrong


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
