"""Columns in memory against the oracle on random specs and traces, by NumPy or the core.

    python -m benchmarks.columns --pairs 10000 --engine c

Traces are filled up, as each row of a column holds a value, and given in blocks of random length.
With `--samples 150` they are longer than what compiled code looks at together. By the engines
without C, records and input health have to be those of a monitor, too. Prints every disagreement
with its seed, and exits with 1 if there is one.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace

from benchmarks.differential import MODELS
from tests.tools.compare import differences
from tests.tools.differential import cases_of
from tests.tools.filled import filled, judge_columns
from tests.tools.frame import frame_differences
from tests.tools.law import judge

from rvmon.errors import RvmonError
from rvmon.monitor import CompiledSpec, build_monitor, compile_spec
from rvmon.monitor.columns.records import JudgedAttempts
from rvmon.readers.alternation import REMARK
from rvmon.testing.case import Case
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.verdict.attempt import Attempt, Decision
from rvmon.verdict.report import Report


def judge_seed(seed: str, options: argparse.Namespace, count: Counter[str]) -> None:
    """Judge the cases of a seed, counting pairs, attempts and disagreements."""
    profile = Profile(MODELS.get(options.time or ""), depth=options.depth)
    traces = TraceProfile(samples=options.samples, span=4 * options.samples)
    rng = random.Random(f"cuts/{seed}")
    compiled = None
    for case in cases_of(seed, profile, traces, options.each):
        whole = filled(case)
        try:
            compiled = compiled or compile_spec(whole.spec)
            cuts = random_cuts(rng, len(whole.samples))
            report = judge_columns(compiled, whole, options.engine, cuts)
        except RvmonError as error:
            print(f"seed {seed}: {error}")
            count["disagreements"] += 1
            continue
        if report is None:
            count["refused"] += 1
            continue
        expected = judge(whole)
        count["pairs"] += 1
        count["by arrays"] += isinstance(report.attempts, JudgedAttempts)
        count["attempts"] += len(expected.attempts)
        found = differences(expected, report) + frame_differences(expected, report)
        if options.engine != "c" and not found:
            found = [*_told_differences(compiled, whole, report)]
        count["disagreements"] += bool(found)
        for line in found:
            print(f"seed {seed}: {line}")


def _told_differences(compiled: CompiledSpec, case: Case, report: Report) -> Iterator[str]:
    """One line per record, or finding on the input, that a monitor would have told otherwise."""
    monitor = build_monitor(compiled, sources=case.names)
    for sample in case.samples:
        monitor.step_ns(sample.t, sample.values)
    told = monitor.finish_ns(case.end)
    networks = {
        name
        for name, one in compiled.requirements.items()
        if one.automaton is None or one.requirement.captures
    }
    for own, other in zip(told.attempts, report.attempts, strict=True):
        # What a network tells of a decision depends on where it was asked before.
        if own.requirement not in networks and _without_doubt(own) != _without_doubt(other):
            yield f"a monitor tells {own}, columns {other}"
    # A monitor sees no frame, of which unknown values may look like those of a merge.
    health = tuple(
        replace(one, remark="") if one.remark == REMARK else one for one in report.health
    )
    if told.health != health:
        yield f"a monitor finds {told.health}, columns {health}"
    if told.counts != report.counts:
        yield f"a monitor counts {told.counts}, columns {report.counts}"


def _without_doubt(attempt: Attempt) -> Attempt:
    """The record without the position at which unknown input was noticed."""
    if attempt.decision is not Decision.OPEN or " not known " not in attempt.reason:
        return attempt
    return replace(attempt, reason="it was unknown")


def random_cuts(rng: random.Random, rows: int) -> list[int]:
    """Up to three places between rows."""
    return sorted(rng.sample(range(1, rows), rng.randrange(min(rows, 4)))) if rows > 1 else []


def parse(argv: Sequence[str]) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--pairs", type=int, default=1_000)
    parser.add_argument("--each", type=int, default=10, help="traces per specification")
    parser.add_argument("--samples", type=int, default=12, help="of a trace, at most")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--engine", choices=("auto", "python", "automaton", "network", "c"), default="auto"
    )
    parser.add_argument("--time", choices=tuple(MODELS), help="the time model; default: any")
    parser.add_argument("--depth", type=int, default=4, help="of the deepest consequent")
    parser.add_argument("--fail-fast", action="store_true", help="stop soon")
    return parser.parse_args(argv)


def main(argv: Sequence[str]) -> int:
    """Judge until there are so many pairs, and print the figures."""
    options = parse(argv)
    count: Counter[str] = Counter()
    number = 0
    while count["pairs"] < options.pairs:
        judge_seed(f"{options.seed}/{number}", options, count)
        number += 1
        if options.fail_fast and count["disagreements"]:
            break
    shown = ", ".join(
        f"{name} {count[name]}"
        for name in ("pairs", "by arrays", "refused", "attempts", "disagreements")
    )
    print(f"columns, engine {options.engine}, seed {options.seed}: {shown}")
    return 1 if count["disagreements"] else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
