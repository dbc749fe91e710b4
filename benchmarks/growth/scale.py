"""Recordings, requirements and tests, ten times as many each time; and a database of coverage."""

from __future__ import annotations

import argparse
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from rvmon.coverage import Hit, Hits, Item, Subject, TestRecord, group_of, model_of
from rvmon.coverage.database import Database

ROWS = 100
"""Of a recording."""

MOST_MEMORY = 6 << 30

GROUPS = 10
DIFFERENT = 100
"""Hits that are drawn ahead, so that drawing them is not measured; tests take them in turn."""


class Cost(NamedTuple):
    """What one process cost, and how it ended."""

    seconds: float
    cpu: float
    mebibytes: float
    code: int
    said: str


def shown(title: str, cost: Cost, more: str = "") -> None:
    """Print a row of the table."""
    said = more or (cost.said if len(cost.said) <= 60 else cost.said[:59] + "…")
    figures = f"{cost.seconds:8.2f}{cost.cpu:8.2f}{cost.mebibytes:8.0f}{cost.code:6}"
    print(f"{title:44}{figures}  {said}", flush=True)


def measured(command: Sequence[str], limit: float) -> Cost:
    """Run one process, at most so many seconds."""

    def bounded() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))

    begun, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(
            command, stdout=output, stderr=output, preexec_fn=bounded, start_new_session=True
        )
        signal.signal(signal.SIGALRM, lambda *_: os.killpg(process.pid, signal.SIGKILL))
        signal.setitimer(signal.ITIMER_REAL, limit)
        _, status, usage = os.wait4(process.pid, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        seconds = time.monotonic() - begun
        output.seek(0)
        lines = output.read()[-4000:].decode(errors="replace").strip().splitlines()
    process.returncode = os.waitstatus_to_exitcode(status)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    said = lines[-1] if lines else ""
    return Cost(seconds, cpu, usage.ru_maxrss / 1024, process.returncode, said)


def rvmon(command: str) -> list[str]:
    """The words that start a subcommand."""
    return [sys.executable, "-m", "rvmon", command]


def scale(options: argparse.Namespace) -> None:
    """Recordings, requirements, tests, ten times as many each time."""
    dice = random.Random(1)

    def recordings(folder: Path, count: int) -> list[str]:
        (folder / "s.rv").write_text(_requirements(10))
        (folder / "data").mkdir()
        text = _recording(dice)
        for number in range(count):
            (folder / "data" / f"{number:06}.csv").write_text(text)
        out = str(folder / "v.csv")
        return [
            *rvmon("run"),
            str(folder / "s.rv"),
            str(folder / "data"),
            "--jobs",
            "2",
            "--out",
            out,
        ]

    def requirements(folder: Path, count: int) -> list[str]:
        (folder / "s.rv").write_text(_requirements(count))
        (folder / "r.csv").write_text(_recording(dice))
        return [*rvmon("run"), str(folder / "s.rv"), str(folder / "r.csv"), "--quiet"]

    def tests(folder: Path, count: int) -> list[str]:
        words = ["-m", "handover.cli", "run", "--strategy", "constrained", "--tests", str(count)]
        return [sys.executable, *words, "--legacy", "--out", str(folder / "out")]

    for work in (recordings, requirements, tests):
        most, last = getattr(options, work.__name__), None
        count = 10 if work is tests else 1
        while count <= most:
            with tempfile.TemporaryDirectory() as name:
                cost = measured(work(Path(name), count), options.limit)
            more = (cost.cpu - last[1]) / (count - last[0]) * 1000 if last else 0.0
            told = f"{more:.2f} ms each more" if last else ""
            shown(f"{count:,} {work.__name__}", cost, told)
            last = count, cost.cpu
            count *= 10


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


def coverage(options: argparse.Namespace) -> None:
    """Record, then look at it and merge it."""
    rng = random.Random(1)
    each = [Item(f"item {item}") for item in range(options.items // GROUPS)]
    groups = [group_of(f"group {n}", Subject.COVERPOINT, each) for n in range(GROUPS)]
    names = [(group.name, item) for group in groups for item in group.items]
    drawn = [_hits(rng, names, options.share) for _ in range(DIFFERENT)]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "a.cov")
        began = time.process_time()
        with Database.open(path) as database:
            database.declare(model_of(groups))
            for number in range(options.tests):
                test = TestRecord(f"test {number}", "campaign", seed=number, number=number)
                database.record(test, drawn[number % DIFFERENT])
        spent = 1000 * (time.process_time() - began) / options.tests
        print(f"record: {spent:.2f} ms a test; {path.stat().st_size / 1e6:.1f} MB")
        page, other = Path(folder, "a.html"), Path(folder, "b.cov")
        for words in ([], ["--tests"], ["--format", "json"], ["--report", str(page)]):
            cost = measured([*rvmon("cover"), str(path), *words], options.limit)
            shown(" ".join(["cover", *words[:1]]), cost, " ")
        print(f"page: {page.stat().st_size / 1e6:.1f} MB")
        merge = measured([*rvmon("cover"), str(path), "--merge", str(other)], options.limit)
        shown("cover --merge", merge)


def _hits(rng: random.Random, names: list[tuple[str, str]], share: float) -> Hits:
    hits: dict[str, dict[str, Hit]] = {}
    for group, item in rng.sample(names, round(len(names) * share)):
        hits.setdefault(group, {})[item] = Hit(rng.randint(1, 50), rng.randrange(60_000_000_000))
    return hits
