"""How cost grows with the work: recordings, requirements, tests.

    python -m benchmarks.growth --recordings 10000 --requirements 10000 --tests 1000

Each is multiplied by ten up to the number given. Prints seconds of CPU (with those of all processes
that were begun), seconds of the clock and the largest resident memory of a process, and what one
recording, requirement or test costs more than at a tenth of them.
"""

from __future__ import annotations

import argparse
import os
import random
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

ROWS = 100
"""Of a recording."""


def _requirements(count: int) -> str:
    """A specification over ten signals: a limit, or a response within a time of its own."""
    lines = [f"signal x{number} : real" for number in range(10)]
    for number in range(count):
        one, other = f"x{number % 10}", f"x{(number + 3) % 10}"
        lines.append(f"requirement R{number}")
        if number % 2:
            lines.append(f"  always {one} < {5 + number % 7}")
        else:
            lines.append(f"  upon {one} > 2 then within {1 + number % 20} s {other} < 1")
    return "\n".join([*lines, ""])


def _recording(dice: random.Random) -> str:
    names = [f"x{number}" for number in range(10)]
    rows = [
        ",".join([str(row), *(f"{dice.gauss(0, 1):.2f}" for _ in names)]) for row in range(ROWS)
    ]
    return "\n".join([",".join(["t", *names]), *rows, ""])


def _cost(words: list[str], folder: Path) -> tuple[float, float, float]:
    """Seconds of CPU and of the clock, MB of the largest process."""
    began, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    process = subprocess.Popen(
        [sys.executable, "-m", *words],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    _, status, usage = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) > 1:
        raise SystemExit(f"{' '.join(words)} ended with {os.waitstatus_to_exitcode(status)}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return cpu, time.perf_counter() - began, usage.ru_maxrss / 1024


def _grown(
    what: str, most: int, words: Callable[[Path, int], list[str]]
) -> Iterator[tuple[str, ...]]:
    """The rows of the table for one kind of work."""
    last: tuple[int, float] | None = None
    count = 1 if what != "tests" else 10
    while count <= most:
        with tempfile.TemporaryDirectory() as name:
            cpu, wall, memory = _cost(words(Path(name), count), Path(name))
        more = "" if last is None else f"{1000 * (cpu - last[1]) / (count - last[0]):.2f} ms"
        yield what, f"{count:,}", f"{cpu:.2f} s", f"{wall:.2f} s", f"{memory:.0f} MB", more
        last = count, cpu
        count *= 10


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--recordings", type=int, default=10_000)
    parser.add_argument("--requirements", type=int, default=1_000)
    parser.add_argument("--tests", type=int, default=100)
    arguments = parser.parse_args()
    dice = random.Random(1)

    def recordings(folder: Path, count: int) -> list[str]:
        (folder / "s.rv").write_text(_requirements(10))
        (folder / "data").mkdir()
        text = _recording(dice)
        for number in range(count):
            (folder / "data" / f"{number:06}.csv").write_text(text)
        return ["rvmon", "run", "s.rv", "data", "--quiet", "--jobs", "2", "--out", "v.csv"]

    def requirements(folder: Path, count: int) -> list[str]:
        (folder / "s.rv").write_text(_requirements(count))
        (folder / "r.csv").write_text(_recording(dice))
        return ["rvmon", "run", "s.rv", "r.csv", "--quiet"]

    def tests(_: Path, count: int) -> list[str]:
        played = ["handover.cli", "run", "--strategy", "constrained", "--tests", str(count)]
        return [*played, "--legacy", "--out", "out"]

    kinds = (("recordings", recordings), ("requirements", requirements), ("tests", tests))
    columns = (14, 8, 12, 12, 10, 12)
    heads = ("", "number", "CPU", "clock", "memory", "each more")
    for row in (
        heads,
        *(row for what, words in kinds for row in _grown(what, getattr(arguments, what), words)),
    ):
        print("".join(f"{cell:>{width}}" for cell, width in zip(row, columns, strict=True)))


if __name__ == "__main__":
    main()
