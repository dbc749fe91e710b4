"""What it takes to close the holes of two campaigns, and what random tests reach.

    python -m benchmarks.closing --seeds 3
    handover run --strategy pseudorandom,constrained --tests 5000 --out out/random
    python -m benchmarks.closing --seeds 1 --random out/random/coverage.db

Printed are tests played, those after which each share of the goals was met, the size of the suite,
and CPU seconds, those of the processes that play included. With `--random`, the same goals but the
edges of the model, which only tests of its runs can show, are looked for in a database of random
tests, one of each strategy in turn.
"""

from __future__ import annotations

import argparse
import resource
import sys
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

from handover.campaign.campaign import handover_campaign
from rvmon.cdv import Campaign
from rvmon.cdv.close import Budget, Closed, close
from rvmon.cdv.close.witnesses import EDGES
from rvmon.coverage.database import read
from rvmon.coverage.questions import Answers

EXAMPLE = Path(__file__).parents[1] / "examples" / "base_and_people"
LOOKED_AT = (25, 50, 100, 200, 500, 1000, 2000, 5000, 10_000)


def main() -> None:
    """Close both campaigns for some seeds, and print what it took."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--first", type=int, default=1, help="the first seed")
    parser.add_argument("--tests", type=int, default=400)
    parser.add_argument("--random", metavar="DB", help="of random tests of the handover")
    arguments = parser.parse_args()
    sys.path.insert(0, str(EXAMPLE))
    from campaign import campaign as people

    closed = None
    for campaign, robot, strategies in (
        (people, "base", ("anyone", "in-the-way")),
        (handover_campaign(("correct",)), "correct", ()),
    ):
        for seed in range(arguments.first, arguments.first + arguments.seeds):
            closed = _timed(campaign, robot, strategies, seed, arguments.tests)
    if arguments.random is not None and closed is not None:
        _look_at(arguments.random, closed)


def _timed(
    campaign: Campaign, robot: str, strategies: tuple[str, ...], seed: int, tests: int
) -> Closed:
    before = _cpu_s()
    closed = close(campaign, robot, seed=seed, strategies=strategies, budget=Budget(tests))
    reached = {}
    for percent in (90, 95, 99, 100):
        needed = percent * closed.goals / 100
        at = [place for place, one in enumerate(closed.tests, 1) if one.met >= needed]
        reached[percent] = str(at[0]) if at else "–"
    shares = "  ".join(f"{percent} % after {at}" for percent, at in reached.items())
    print(
        f"{campaign.name}, seed {seed}: {closed.met} of {closed.goals} goals by "
        f"{len(closed.tests)} tests, {_cpu_s() - before:.1f} s of CPU; {shares}; suite "
        f"{closed.needed} ({closed.sizes}), at least {closed.fewest}",
        flush=True,
    )
    return closed


def _cpu_s() -> float:
    own, played = (
        resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return own.ru_utime + own.ru_stime + played.ru_utime + played.ru_stime


def _look_at(path: str, closed: Closed) -> None:
    """The share of the goals of a closed campaign that random tests met."""
    goals = {goal for one in closed.tests for goal in one.goals if goal[0] != EDGES}
    goals |= {goal for goal in closed.open if goal[0] != EDGES}
    coverage = read([path])
    met: set[tuple[str, str]] = set()
    for number, place in enumerate(_in_turn([*Answers(coverage).strategies.values()]), 1):
        row = coverage.entries[place].row
        met |= goals & {coverage.items[item] for item in row.items.tolist()}
        if number in LOOKED_AT:
            print(
                f"{number:,} random tests: {len(met)} of {len(goals)}, {len(met) / len(goals):.1%}"
            )
    print("never met:", ", ".join(f"{group}: {item}" for group, item in sorted(goals - met)))


def _in_turn(several: list[list[int]]) -> Iterator[int]:
    return chain.from_iterable(zip(*several, strict=False))


if __name__ == "__main__":
    main()
