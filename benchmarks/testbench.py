"""Measure the testbench: faults it detects, holes it closes, failures it shrinks.

    python -m benchmarks.testbench faults --tests 60
    python -m benchmarks.testbench closing --seeds 3
    python -m benchmarks.testbench shrinking --failures 20

`faults`: sixty faults of the kind that a programmer could make who knows only
`handover.robot.handover`: a forgotten line, two lines in the wrong order, a misunderstood rule, or
a well-meant change. Directed and disturbed tests are played on each until a requirement fails.
Prints what detects it: a requirement, a signal that nothing judges, or nothing.

`closing`: the number of tests needed to close the holes of the handover, without and with the tests
written by people; how many tests added a goal, after how many each share was met, the size of the
suite, and CPU seconds of all processes.

`shrinking`: failing tests of robots with a planted fault, from the model and the first of each
random strategy. Prints actions before and after, tests played, and CPU seconds of this process.
"""

from __future__ import annotations

import ast
import inspect
import os
import sys
import time
import tomllib
from bisect import bisect_left
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from pathlib import Path
from statistics import median

from benchmarks.program import program
from msgspec import structs

from handover.campaign.campaign import handover_campaign
from handover.generator.abstract_test import AbstractTest
from handover.robot import handover as code
from handover.robot.handover import HandoverRobot
from handover.robot.mutants import MUTATIONS
from rvmon.cdv.campaign_plan import Job, plan
from rvmon.cdv.close import Budget, close
from rvmon.cdv.mutation.baseline import record_suite
from rvmon.cdv.mutation.play import play_mutants
from rvmon.cdv.mutation.python_mutants import Mutant
from rvmon.cdv.mutation.survivors import How, Tried
from rvmon.cdv.play import player
from rvmon.cdv.shrink import Shrunk, shrink

FAULTS = tomllib.loads(Path(__file__).with_name("planted_faults.toml").read_text("utf-8"))
STRATEGIES = ("constrained", "pseudorandom", "model-based", "model-based-fastest")


def faults(*, tests: int = 60, seed: int = 1) -> int:
    """Print what detects each planted fault; exit 1 if a fault cannot be planted."""
    campaign = handover_campaign(("correct",))
    strategies = ("directed", "disturbed")
    chosen = plan(campaign, strategies, tests=tests, seed=seed).tests
    jobs = os.cpu_count() or 1
    played = [test for several in chosen.values() for test in several]
    suite = record_suite(campaign, "correct", played, jobs=jobs)
    tried = play_mutants(suite, [_mutant(name) for name in FAULTS], jobs=jobs)
    sees: Counter[str] = Counter()
    for name, one in zip(FAULTS, tried, strict=True):
        by, what = _seen(one)
        sees[by] += 1
        print(f"{name:48} {by}{what}")
    print(", ".join(f"{count} of {len(tried)} by {by}" for by, count in sees.most_common()))
    return int(any(one.invalid for one in tried))


def _seen(one: Tried) -> tuple[str, str]:
    """What detects a fault, and details; the strongest evidence is chosen."""
    if one.invalid:
        return "invalid", f": {one.invalid}"
    if one.findings:
        best = min(one.findings, key=lambda found: found.how is not How.REQUIREMENT)
        return best.how, f" {', '.join(best.what)} ({best.test})"
    if one.difference is not None:
        found = one.difference
        return "a signal that nothing judges", f" {found.name} ({found.test})"
    return "nothing", f", {one.reaching} tests run it"


def _mutant(name: str) -> Mutant:
    path = Path(inspect.getsourcefile(code) or "")
    source = path.read_text(encoding="utf-8")
    before, after = FAULTS[name]
    at = source.index(before)
    line = source.count("\n", 0, at) + 1
    whole = source[:at] + after + source[at + len(before) :]
    return Mutant(path, line, "fresh", before, after, whole, _place(source, line))


def _place(source: str, line: int) -> str:
    """The qualified name of the function around a line, otherwise the constant that it defines."""
    for part in ast.walk(ast.parse(source)):
        if isinstance(part, ast.FunctionDef) and part.lineno <= line <= (part.end_lineno or 0):
            return f"{HandoverRobot.__name__}.{part.name}"
    return source.splitlines()[line - 1].split()[0]


def closing(*, tests: int = 400, seeds: int = 3, seed: int = 1) -> None:
    """Close the holes of campaigns, with at most `tests` tests each, and print the results."""
    handover = handover_campaign(("correct",))
    unwritten = replace(handover.closing, written=())
    for campaign in (
        replace(handover, name="handover, nothing written", closing=unwritten),
        handover,
    ):
        for number in range(seed, seed + seeds):
            before = sum(os.times()[:4])  # including child processes
            closed = close(campaign, "correct", seed=number, budget=Budget(tests))
            spent, met = sum(os.times()[:4]) - before, [one.met for one in closed.tests]
            shares = (
                f"{percent} % after {bisect_left(met, percent * closed.goals / 100) + 1}"
                for percent in (90, 95, 99, 100)
                if closed.met >= percent * closed.goals / 100
            )
            print(
                f"{campaign.name}, seed {number}: {closed.met} of {closed.goals} goals by "
                f"{len(met)} tests, {sum(bool(one.goals) for one in closed.tests)} of which added "
                f"one, {spent:.1f} s of CPU; {'  '.join(shares)}; suite {closed.needed} "
                f"({closed.sizes}), at least {closed.fewest}",
                flush=True,
            )


def shrinking(*, failures: int = 20, seed: int = 1) -> None:
    """Shrink `failures` failing tests and print the results."""
    times, left = [], []
    for test, found, seconds in islice(_failures(seed), failures):
        times.append(seconds)
        left.append(len(found.test.actions))
        sizes = f"{len(test.actions):2} → {left[-1]:2} actions"
        print(f"{test.name:45} {sizes}  {found.tried:3} tests  {seconds:.2f} s  {found.failure}")
    print(
        f"{len(times)} failures: median {median(left):g} actions, {median(times):.2f} s, "
        f"at most {max(times):.2f} s"
    )


def _failures(seed: int) -> Iterator[tuple[AbstractTest, Shrunk[AbstractTest], float]]:
    """Yield failing tests, each with the smallest test found and the CPU seconds used."""
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
    sys.exit(program(__doc__, faults, closing, shrinking))
