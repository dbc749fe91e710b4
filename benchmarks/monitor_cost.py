"""What judging costs: a campaign with and without monitors.

    python -m benchmarks.monitor_cost --repeats 3

Each repetition plays the same 200 tests against each robot with monitors and without, in turn, in
one process; the least processor time of each counts. The wall time on all cores stands beside it.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence

from handover.campaign.campaign import handover_campaign
from rvmon.cdv.execute import execute
from rvmon.cdv.plan import Plan, plan

STRATEGIES = ("pseudorandom", "constrained")
ROBOTS = ("legacy", "correct")


def main(argv: Sequence[str] | None = None) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--tests", type=int, default=100, help="per strategy and robot")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(argv)
    plans = {
        monitors: plan(
            handover_campaign(ROBOTS, monitors=monitors),
            STRATEGIES,
            tests=options.tests,
            seed=options.seed,
        )
        for monitors in (True, False)
    }
    processor: dict[bool, list[float]] = {True: [], False: []}
    wall: dict[bool, list[float]] = {True: [], False: []}
    for _ in range(options.repeats):
        for monitors, chosen in plans.items():
            processor[monitors].append(processor_seconds(chosen))
            wall[monitors].append(execute(chosen, controls=False).seconds)
    tests = len(plans[True].jobs())
    print(f"{tests} tests, least of {options.repeats} repetitions")
    for name, seconds in (("one process, processor", processor), ("all cores, wall", wall)):
        with_, without = min(seconds[True]), min(seconds[False])
        print(
            f"{name:<24} with monitors {with_:6.2f} s, without {without:6.2f} s: "
            f"{1000 * (with_ - without) / tests:.2f} ms per test, {with_ / without:.2f}×"
        )
    return 0


def processor_seconds(chosen: Plan) -> float:
    """Processor time of a campaign in this process."""
    start = time.process_time()
    execute(chosen, jobs=1, controls=False)
    return time.process_time() - start


if __name__ == "__main__":
    sys.exit(main())
