"""Failing tests of robots with a planted fault, shrunk: what is left of them, and how soon.

    python -m benchmarks.shrinking --failures 20

Prints for each the actions before and after, the tests that were played and the CPU seconds of this
process. The tests are those of the model and the first of each random strategy, on every mutant in
turn.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from itertools import islice
from statistics import median

from msgspec import structs

from handover.campaign.campaign import handover_campaign
from handover.generator.abstract_test import AbstractTest
from handover.robot.mutants import MUTATIONS
from rvmon.cdv.plan import Job, plan
from rvmon.cdv.play import player
from rvmon.cdv.shrink import Shrunk, shrink

STRATEGIES = ("constrained", "pseudorandom", "model-based", "model-based-fastest")


def main() -> int:
    """Shrink and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--failures", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1, help="of the tests")
    arguments = parser.parse_args()
    times, left = [], []
    for test, found, seconds in islice(failures(arguments.seed), arguments.failures):
        times.append(seconds)
        left.append(len(found.test.actions))
        sizes = f"{len(test.actions):2} → {left[-1]:2} actions"
        print(f"{test.name:45} {sizes}  {found.tried:3} tests  {seconds:.2f} s  {found.failure}")
    print(
        f"{len(times)} failures: median {median(left):g} actions, {median(times):.2f} s, "
        f"at most {max(times):.2f} s"
    )
    return 0


def failures(seed: int) -> Iterator[tuple[AbstractTest, Shrunk[AbstractTest], float]]:
    """Each test that fails, with the smallest one and the CPU seconds that this took."""
    campaign = handover_campaign(("correct",))
    play = player(campaign.robots, None, None)
    planned = plan(campaign, STRATEGIES, tests=4, seed=seed).tests.values()
    for number in range(max(map(len, planned))):
        for mutation in MUTATIONS:
            for test in (tests[number] for tests in planned if number < len(tests)):
                if not isinstance(test, AbstractTest):
                    continue
                name = f"{test.name} {mutation}"
                faulty = structs.replace(test, name=name, mutation=mutation)
                outcome = play(Job(faulty, "correct"))[0]
                began = time.process_time()
                found = shrink(faulty, outcome, lambda one: play(Job(one, "correct"))[0])
                if found is not None:
                    yield faulty, found, time.process_time() - began


if __name__ == "__main__":
    raise SystemExit(main())
