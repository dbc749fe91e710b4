"""Recordings, requirements and tests, ten times as many each time; and a database of coverage."""

from __future__ import annotations

import random
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from benchmarks.process import Cost, measured

from rvmon.coverage import Hit, Hits, Item, Subject, TestRecord, group_of, model_of
from rvmon.coverage.database import Database

RVMON = (sys.executable, "-m", "rvmon")
NAMES = [f"x{number}" for number in range(10)]
ROWS = 100
"""Of a recording."""

MOST_MEMORY = 6 << 30

HEAD = f"{'':44}{'s':>8}{'CPU s':>8}{'MiB':>8}{'exit':>6}"
"""Of the table of processes."""

GROUPS = 10
DIFFERENT = 100
"""Hits that are drawn ahead, so that drawing them is not measured; tests take them in turn."""


def cost_of(
    title: str, command: Sequence[str], limit: float, last: float = 0, more: int = 0
) -> Cost:
    """Run a process and print a row of the table, with what each more costs than the last time."""
    cost = measured(command, limit, memory=MOST_MEMORY)
    said = cost.said if len(cost.said) <= 60 else cost.said[:59] + "…"
    if more:
        said = f"{(cost.cpu - last) / more * 1000:.2f} ms each more"
    figures = f"{cost.seconds:8.2f}{cost.cpu:8.2f}{cost.mebibytes:8.0f}{cost.code:6}"
    print(f"{title:44}{figures}  {said}", flush=True)
    return cost


def scale(
    *,
    recordings: int = 10_000,
    requirements: int = 1_000,
    tests: int = 100,
    limit: float = 600.0,
) -> None:
    """Recordings, requirements, tests, ten times as many each time."""
    works: Sequence[tuple[str, Callable[[Path, int], list[str]], int, int]] = (
        ("recordings", _recordings, 1, recordings),
        ("requirements", _one_recording, 1, requirements),
        ("tests", _tests, 10, tests),
    )
    print(HEAD)
    for what, work, count, most in works:
        last, before = 0.0, 0
        while count <= most:
            with tempfile.TemporaryDirectory() as name:
                more = count - before if before else 0
                command = work(Path(name), count)
                last = cost_of(f"{count:,} {what}", command, limit, last, more).cpu
            before, count = count, 10 * count


def _recordings(folder: Path, count: int) -> list[str]:
    """What judges so many recordings, and writes their verdicts."""
    (folder / "s.rv").write_text(_requirements(10))
    (folder / "data").mkdir()
    for number in range(count):
        (folder / "data" / f"{number:06}.csv").write_text(_recording())
    out = ["--jobs", "2", "--out", str(folder / "v.csv")]
    return [*RVMON, "run", str(folder / "s.rv"), str(folder / "data"), *out]


def _one_recording(folder: Path, count: int) -> list[str]:
    """What judges a recording by so many requirements."""
    (folder / "s.rv").write_text(_requirements(count))
    (folder / "r.csv").write_text(_recording())
    return [*RVMON, "run", str(folder / "s.rv"), str(folder / "r.csv"), "--quiet"]


def _tests(folder: Path, count: int) -> list[str]:
    """What plays so many tests of the handover."""
    words = ["run", "--strategy", "constrained", "--tests", str(count), "--legacy"]
    return [sys.executable, "-m", "handover.cli", *words, "--out", str(folder / "out")]


def _requirements(count: int) -> str:
    """A specification over ten signals: a limit, or a response within a time of its own."""
    lines = [f"signal {name} : real" for name in NAMES]
    for number in range(count):
        one, other = NAMES[number % 10], NAMES[(number + 3) % 10]
        lines.append(f"requirement R{number}")
        if number % 2:
            lines.append(f"  always {one} < {5 + number % 7}")
        else:
            lines.append(f"  upon {one} > 2 then within {1 + number % 20} s {other} < 1")
    return "\n".join([*lines, ""])


def _recording() -> str:
    dice = random.Random(1)
    rows = (
        ",".join([str(row), *(f"{dice.gauss(0, 1):.2f}" for _ in NAMES)]) for row in range(ROWS)
    )
    return "\n".join([",".join(["t", *NAMES]), *rows, ""])


def coverage(
    *, tests: int = 10_000, items: int = 1_000, share: float = 0.2, limit: float = 600.0
) -> None:
    """A database of coverage: record, then look at it and merge it."""
    print(HEAD)
    rng = random.Random(1)
    each = [Item(f"item {item}") for item in range(items // GROUPS)]
    groups = [group_of(f"group {n}", Subject.COVERPOINT, each) for n in range(GROUPS)]
    names = [(group.name, item) for group in groups for item in group.items]
    drawn = [_hits(rng, names, share) for _ in range(DIFFERENT)]
    with tempfile.TemporaryDirectory() as folder:
        path, page, other = (Path(folder, name) for name in ("a.cov", "a.html", "b.cov"))
        began = time.process_time()
        with Database.open(path) as database:
            database.declare(model_of(groups))
            for number in range(tests):
                test = TestRecord(f"test {number}", "campaign", seed=number, number=number)
                database.record(test, drawn[number % DIFFERENT])
        spent = 1000 * (time.process_time() - began) / tests
        print(f"record: {spent:.2f} ms a test; {path.stat().st_size / 1e6:.1f} MB")
        for words in ([], ["--tests"], ["--format", "json"], ["--report", str(page)]):
            command = [*RVMON, "cover", str(path), *words]
            cost_of(" ".join(["cover", *words[:1]]), command, limit)
        print(f"page: {page.stat().st_size / 1e6:.1f} MB")
        merge = [*RVMON, "cover", str(path), "--merge", str(other)]
        cost_of("cover --merge", merge, limit)


def _hits(rng: random.Random, names: list[tuple[str, str]], share: float) -> Hits:
    hits: dict[str, dict[str, Hit]] = {}
    for group, item in rng.sample(names, round(len(names) * share)):
        hits.setdefault(group, {})[item] = Hit(rng.randint(1, 50), rng.randrange(60_000_000_000))
    return hits
