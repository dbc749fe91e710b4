"""What a database of coverage costs: to record tests, on the disk, and to look at.

    python -m benchmarks.coverage_database [--tests 10000] [--items 1000] [--share 0.2]

Each test hits a random share of the items, with random counts and instants: real ones repeat, and
take less room.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import random
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from rvmon.cli import main as rvmon
from rvmon.coverage.database import Database, merge
from rvmon.coverage.model import Hit, Hits, Item, Subject, group_of, model_of
from rvmon.coverage.record import TestRecord

GROUPS = 10
DIFFERENT = 100
"""Hits that are drawn ahead, so that drawing them is not measured; tests take them in turn."""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tests", type=int, default=10_000)
    parser.add_argument("--items", type=int, default=1_000)
    parser.add_argument("--share", type=float, default=0.2)
    arguments = parser.parse_args()
    rng = random.Random(1)
    groups = [
        group_of(
            f"group {number}",
            Subject.COVERPOINT,
            [Item(f"item {item}") for item in range(arguments.items // GROUPS)],
        )
        for number in range(GROUPS)
    ]
    names = [(group.name, item) for group in groups for item in group.items]
    drawn = [_hits(rng, names, arguments.share) for _ in range(DIFFERENT)]
    with tempfile.TemporaryDirectory() as folder:
        path, other = Path(folder, "a.cov"), Path(folder, "b.cov")

        def record() -> None:
            with Database.open(path) as database:
                database.declare(model_of(groups))
                for number in range(arguments.tests):
                    test = TestRecord(f"test {number}", "campaign", seed=number, number=number)
                    database.record(test, drawn[number % DIFFERENT])

        each = _seconds(record) / arguments.tests
        print(f"record: {1e3 * each:.2f} ms a test, {arguments.tests * each:.1f} s in all")
        print(f"size: {path.stat().st_size / 1e6:.1f} MB")
        page = Path(folder, "a.html")
        for words in ([], ["--tests"], ["--format", "json"], ["--report", str(page)]):
            seconds = _seconds(partial(_quietly, ["cover", str(path), *words]))
            print(f"rvmon {' '.join(['cover', *words[:1]])}: {seconds:.2f} s")
        print(f"page: {page.stat().st_size / 1e6:.1f} MB")
        print(f"merge with nothing: {_seconds(lambda: merge([path], other)):.2f} s")


def _hits(rng: random.Random, names: list[tuple[str, str]], share: float) -> Hits:
    hits: dict[str, dict[str, Hit]] = {}
    for group, item in rng.sample(names, round(len(names) * share)):
        hits.setdefault(group, {})[item] = Hit(rng.randint(1, 50), rng.randrange(60_000_000_000))
    return hits


def _seconds(work: Callable[[], object]) -> float:
    """What something takes of this process's time."""
    before = time.process_time()
    work()
    return time.process_time() - before


def _quietly(command: list[str]) -> None:
    with contextlib.redirect_stdout(io.StringIO()):
        rvmon(command)


if __name__ == "__main__":
    main()
