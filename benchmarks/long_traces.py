"""The core against progression, on traces too long for the law: what is kept over time stays right.

    python -m benchmarks.long_traces --traces 500 --positions 10000 --seed 1

Progression makes the locations of an automaton when it needs them; it shares the reading of inputs
with the core, and nothing of how attempts are judged. Windows within windows, a fourth of the
specifications, are judged by the network of Python instead: of these progression would owe too much
at once. Prints every disagreement, with its seed, and exits 1 if there is one.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from tests.tools.chains import random_chain
from tests.tools.compare import differences
from tests.tools.core_forms import ByRows, Stepped
from tests.tools.drive import drive

from rvmon.automaton.progression import TooManyObligationsError
from rvmon.errors import RvmonError
from rvmon.monitor import build_monitor, compile_spec
from rvmon.monitor.engines.registry import engine_named
from rvmon.testing.case import Case
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import TraceProfile, random_trace

PROFILE = Profile(mixed=False, depth=3, wide=20)


@dataclass(slots=True)
class Compared:
    """What came of some traces.

    Attributes:
        traces: so many were judged by both.
        samples: in them.
        attempts: in them, by verdict.
        passed_over: specifications that one of both is not to judge.
        found: one text for each disagreement.
    """

    traces: int = 0
    samples: int = 0
    attempts: Counter[str] = field(default_factory=Counter)
    passed_over: int = 0
    found: list[str] = field(default_factory=list)


def long_cases(seed: object, positions: int) -> Iterator[tuple[str, Case]]:
    """Random cases without end, of so many samples, every fifth sparse; and who judges them."""
    for number in range(sys.maxsize):
        rng = random.Random(f"{seed}/{number}")
        engine = "network" if number % 4 == 3 else "progression"
        spec = random_spec(rng, PROFILE) if number % 4 < 3 else random_chain(rng, untils=True)
        sparse = 100 if number % 5 == 0 else 0
        length = TraceProfile(positions, positions, span=1 << 40, sparse=sparse)
        yield engine, random_trace(rng, spec, length)


def compared(cases: Iterable[tuple[str, Case]], traces: int) -> Compared:
    """Have both judge, until so many traces are judged."""
    total = Compared()
    for number, (engine, case) in enumerate(cases):
        if total.traces >= traces:
            return total
        found = _compared(engine, case, total)
        total.found += [f"case {number}\n" + "\n".join(found)] if found else []
    raise AssertionError("there are no more cases")


def _compared(reference: str, case: Case, total: Compared) -> list[str]:
    engines = engine_named(reference), engine_named("c")
    try:
        compiled = compile_spec(case.spec)
        requirements = compiled.requirements.values()
        if any(engine.refuses(one) for engine in engines for one in requirements):
            raise RvmonError("not for both")
        slow = build_monitor(compiled, engine=reference, sources=case.names)
        expected, _ = drive(slow, case)
    except (RvmonError, TooManyObligationsError):
        total.passed_over += 1
        return []
    total.traces += 1
    total.samples += len(case.samples)
    total.attempts.update(one.verdict.value for one in expected.attempts)
    stepped, _ = drive(Stepped(compiled, case), case)
    by_rows, _ = drive(ByRows(compiled, case), case)
    return [*differences(expected, stepped), *differences(expected, by_rows)]


def main(words: list[str]) -> int:
    """Compare, and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.long_traces")
    parser.add_argument("--traces", type=int, default=500)
    parser.add_argument("--positions", type=int, default=10_000, help="samples of a trace")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(words)
    began = time.process_time()
    total = compared(long_cases(options.seed, options.positions), options.traces)
    for text in total.found:
        print(text)
    verdicts = ", ".join(f"{name} {count:,}" for name, count in sorted(total.attempts.items()))
    print(
        f"{total.traces} traces, {total.samples:,} samples, attempts {verdicts}; "
        f"{total.passed_over} passed over; disagreements {len(total.found)}; "
        f"{time.process_time() - began:.0f} s of CPU time"
    )
    return 1 if total.found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
