"""The testbench at work: faults that it sees, holes that it closes, failures that it shrinks.

    python -m benchmarks.testbench faults --tests 60
    python -m benchmarks.testbench closing --seeds 3
    python -m benchmarks.testbench shrinking --failures 20

`faults`: sixty, each what somebody may write who reads `handover.robot.handover` alone: a line
forgotten, two in the wrong order, a rule misunderstood, or a change that is meant well. Directed
and disturbed tests are played on each until a requirement fails. Prints what sees it: a
requirement, a signal that nobody judges, or nothing.

`closing`: tests that it takes to close the holes of two campaigns, those after which each share of
the goals was met, the size of the suite, and CPU seconds of all processes. With `--random DB`, a
database of `handover run --strategy pseudorandom,constrained --tests 5000`, the share of the same
goals (but for the edges of the model, which only tests of its runs can show) that random tests met.

`shrinking`: failing tests of robots with a planted fault, those of the model and the first of each
random strategy: actions before and after, tests that were played, CPU seconds of this process.
"""

from __future__ import annotations

import argparse
import ast
import inspect
import os
import resource
import sys
import time
from collections.abc import Iterator
from itertools import chain, islice
from pathlib import Path
from statistics import median

from benchmarks.planted_faults import FAULTS
from msgspec import structs

from handover.campaign.campaign import handover_campaign
from handover.generator.abstract_test import AbstractTest
from handover.robot import handover
from handover.robot.handover import HandoverRobot
from handover.robot.mutants import MUTATIONS
from rvmon.cdv import Campaign
from rvmon.cdv.close import Budget, Closed, close
from rvmon.cdv.close.goals import EDGES
from rvmon.cdv.mutation.baseline import record_suite
from rvmon.cdv.mutation.play import play_mutants
from rvmon.cdv.mutation.python_mutants import Mutant
from rvmon.cdv.plan import Job, plan
from rvmon.cdv.play import player
from rvmon.cdv.shrink import Shrunk, shrink
from rvmon.coverage.database import read
from rvmon.coverage.questions import Answers

EXAMPLE = Path(__file__).parents[1] / "examples" / "base_and_people"
LOOKED_AT = (25, 50, 100, 200, 500, 1000, 2000, 5000, 10_000)
STRATEGIES = ("constrained", "pseudorandom", "model-based", "model-based-fastest")


def faults(options: argparse.Namespace) -> int:
    """Plant, play, print; 1 if a fault cannot be planted."""
    campaign = handover_campaign(("correct",))
    strategies = ("directed", "disturbed")
    chosen = plan(campaign, strategies, tests=options.tests or 60, seed=options.seed).tests
    jobs = os.cpu_count() or 1
    tests = [test for several in chosen.values() for test in several]
    suite = record_suite(campaign, "correct", tests, jobs=jobs)
    tried = play_mutants(suite, [_mutant(name) for name in FAULTS], jobs=jobs)
    unseen = 0
    for name, one in zip(FAULTS, tried, strict=True):
        seen = next((found for found in one.findings), None)
        unseen += seen is None
        if one.invalid:
            what = f"invalid: {one.invalid}"
        elif seen is not None:
            what = f"{seen.how} {', '.join(seen.what)} ({seen.test})"
        elif one.difference is not None:
            what = f"a signal that nothing judges: {one.difference}"
        else:
            what = f"nothing, {one.reaching} tests run it"
        print(f"{name:45} {what}", flush=True)
    print(f"{len(tried) - unseen} of {len(tried)} faults are seen")
    return int(any(one.invalid for one in tried))


def _mutant(name: str) -> Mutant:
    path = Path(inspect.getsourcefile(handover) or "")
    source = path.read_text(encoding="utf-8")
    before, after = FAULTS[name]
    at = source.index(before)
    line = source.count("\n", 0, at) + 1
    whole = source[:at] + after + source[at + len(before) :]
    return Mutant(path, line, "fresh", before, after, whole, _place(source, line))


def _place(source: str, line: int) -> str:
    """The qualified name of the function that a line is in; else that of its constant."""
    for part in ast.parse(source).body:
        for inner in part.body if isinstance(part, ast.ClassDef) else ():
            is_function = isinstance(inner, ast.FunctionDef)
            if is_function and inner.lineno <= line <= (inner.end_lineno or 0):
                return f"{HandoverRobot.__name__}.{inner.name}"
    return source.splitlines()[line - 1].split()[0]


def closing(options: argparse.Namespace) -> int:
    """Close both campaigns for some seeds."""
    sys.path.insert(0, str(EXAMPLE))
    from campaign import campaign as people

    closed = None
    for campaign, robot, strategies in (
        (people, "base", ("anyone", "in-the-way")),
        (handover_campaign(("correct",)), "correct", ()),
    ):
        for seed in range(options.seed, options.seed + options.seeds):
            closed = _timed(campaign, robot, strategies, seed, options.tests or 400)
    if options.random is not None and closed is not None:
        _look_at(options.random, closed)
    return 0


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


def shrinking(options: argparse.Namespace) -> int:
    """Shrink and print."""
    times, left = [], []
    for test, found, seconds in islice(failures(options.seed), options.failures):
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


def main() -> int:
    """Play and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("faults", "closing", "shrinking"))
    parser.add_argument("--seed", type=int, default=1, help="the first")
    parser.add_argument("--seeds", type=int, default=3, help="closing: so many")
    parser.add_argument("--tests", type=int, help="disturbed ones (60), or of a campaign (400)")
    parser.add_argument("--failures", type=int, default=20, help="shrinking: so many")
    parser.add_argument("--random", metavar="DB", help="closing: of random tests of the handover")
    options = parser.parse_args()
    return {"faults": faults, "closing": closing, "shrinking": shrinking}[options.what](options)


if __name__ == "__main__":
    sys.exit(main())
