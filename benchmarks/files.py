"""Whole files by wall time: a large one, many, and a tiny one, where starting is what counts."""

from __future__ import annotations

import gzip
import json
import os
import random
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.peers.environment import Environment
from benchmarks.processes import as_installed

BY_DUCKDB = Path(__file__).parent / "peers" / "csv_with_duckdb.py"
PERIOD = 10_000_000
EACH = 10_000
"""Rows of each of many files."""

SPEC = """spec files
signal speed, obstacle : real
event stop
requirement B1
  always (obstacle < 0.5 -> speed <= 0.3)
requirement B2
  upon stop
  then within 500 ms speed <= 0.05
"""

Failures = list[list[tuple[str, int]]]
"""Of each file, the requirements that failed and the instants at which the attempts began."""


@dataclass(slots=True)
class Task:
    """A way to judge some files.

    Attributes:
        what: is judged.
        who: judges.
        commands: one after the other.
        read: the failures from what they print; `None`: they are not looked at.
        wall: seconds of each pass.
        cpu: the same.
        failures: of the last pass.
        refusal: why it was not measured.
    """

    what: str
    who: str
    commands: Sequence[Sequence[str]]
    read: Callable[[str], Failures] | None
    wall: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)
    failures: Failures = field(default_factory=list)
    refusal: str = ""


def measure_files(
    rows: int, many: int, repeats: int, environment: Environment, folder: Path
) -> Iterator[str]:
    """The table of what whole files take.

    Args:
        rows: of the large file.
        many: files of `EACH` rows.
        repeats: passes of each task; if several, beside a first one that does not count.
        environment: may have DuckDB.
        folder: for the files.
    """
    yield "| files | by | wall (least to most) | CPU | the first over this | failures |"
    yield "|---|---|---|---|---|---|"
    tasks = list(_tasks(rows, many, environment, folder))
    refused = [task for task in tasks if task.refusal]
    installed = as_installed(folder)
    for what in dict.fromkeys(task.what for task in tasks):
        own = [task for task in tasks if task.what == what and not task.refusal]
        for number in range(-1 if repeats > 1 else 0, repeats):
            for task in own:
                _pass(task, installed, counts=number >= 0)
        refused += [task for task in own if task.refusal]
        yield from _lines([task for task in own if not task.refusal])
    if refused:
        yield ""
        told = "; ".join(f"{task.who}, {task.what}: {task.refusal}" for task in refused)
        yield f"Not measured: {told}."


def _tasks(rows: int, many: int, environment: Environment, folder: Path) -> Iterator[Task]:
    spec = folder / "files.rv"
    spec.write_text(SPEC)
    rvmon = (sys.executable, "-m", "rvmon")
    run = (*rvmon, "run", str(spec), "--format", "json")
    large = str(written(folder / "large.csv", rows, 0))
    what = f"{rows:,} rows"
    duckdb = "" if "duckdb" in environment.versions else environment.missing.get("duckdb", "none")
    query = (str(environment.python), str(BY_DUCKDB), large)
    yield Task(what, "DuckDB", [query], _told, refusal=duckdb)
    yield Task(what, "rvmon run", [(*run, large)], _failures)
    plain = written(folder / "plain.csv", rows // 10, 0)
    what = f"{rows // 10:,} rows"
    yield Task(what, "rvmon run", [(*run, str(plain))], _failures)
    for name, path in _odd(plain).items():
        yield Task(what, f"rvmon run, {name}", [(*run, str(path))], _failures)
    page = str(folder / "page")
    yield Task(what, "rvmon run --report", [(*run, "--report", page, str(plain))], _failures)
    files = [str(written(folder / f"file{number:04}.csv", EACH, number)) for number in range(many)]
    what = f"{many:,} files of {EACH:,} rows"
    yield Task(what, "rvmon run", [(*run, *files)], _failures)
    yield Task(what, "rvmon run --jobs 2", [(*run, "--jobs", "2", *files)], _failures)
    tiny = str(written(folder / "tiny.csv", 10, 0))
    yield Task("10 rows", "rvmon run", [(*run, tiny)], _failures)
    yield Task("10 rows", "rvmon check", [(*rvmon, "check", str(spec))], None)


def _odd(plain: Path) -> Mapping[str, Path]:
    """The same recording as other programs write it, by what is odd about it."""
    header, *rows = plain.read_text().splitlines()
    texts = {
        "quoted header": [",".join(f'"{name}"' for name in header.split(",")), *rows],
        "a byte order mark": ["\ufeff" + header, *rows],
        "quoted text in each row": [f"{header},note", *(f'{row},"a ""b"", c"' for row in rows)],
        "a doubled row": [header, *rows[:9], *rows[8:]],
        "ends of Windows": [line + "\r" for line in (header, *rows)],
    }
    found = {}
    for number, (name, lines) in enumerate(texts.items()):
        found[name] = plain.with_name(f"odd{number}.csv")
        found[name].write_text("\n".join([*lines, ""]), newline="")
    packed = plain.with_name("packed.csv.gz")
    with gzip.open(packed, "wb", compresslevel=1) as file:
        file.write(plain.read_bytes())
    return {**found, "packed": packed}


def written(path: Path, rows: int, seed: int) -> Path:
    """A recording of a base whose values change at every row and that now and then disobeys.

    Args:
        path: to write to.
        rows: how many.
        seed: of the values.
    """
    rng = random.Random(seed)
    speeds = [f"{0.3 + rng.random():.3f}" for _ in range(997)]
    distances = [f"{0.6 + 10 * rng.random():.2f}" for _ in range(1009)]
    slow, late = -1, rows - 100  # no stop is open at the end
    with path.open("w") as file:
        file.write("t_ns,speed,obstacle,stop\n")
        for row in range(rows):
            stops = row < late and rng.random() < 0.0005
            if stops and slow < row:
                slow = row + rng.randrange(5, 60)
            speed = "0.02" if row == slow else speeds[row % 997]
            distance = "0.3" if rng.random() < 1e-5 else distances[row % 1009]
            file.write(f"{row * PERIOD},{speed},{distance},{int(stops)}\n")
    return path


def _pass(task: Task, installed: Mapping[str, str], *, counts: bool) -> None:
    """Run a task's commands once in an environment; one that cannot has its refusal noted."""
    if task.refusal:
        return
    cpu, wall, printed = os.times(), time.monotonic(), []
    for command in task.commands:
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=installed)
        if done.returncode not in (0, 1):
            said = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
            task.refusal = said[-1]
            return
        printed.append(done.stdout)
    wall, spent = time.monotonic() - wall, os.times()
    if counts:
        task.wall.append(wall)
        before = cpu.children_user + cpu.children_system
        task.cpu.append(spent.children_user + spent.children_system - before)
    if task.read is not None:
        task.failures = [found for text in printed for found in task.read(text)]


def _failures(printed: str) -> Failures:
    reports = json.loads(printed)
    found = []
    for report in reports if isinstance(reports, list) else [reports]:
        failed = [
            (name, attempt["triggered"])
            for name, entry in report["requirements"].items()
            for attempt in entry["attempts"]
            if attempt["verdict"] == "F"
        ]
        found.append(sorted(failed))
    return found


def _told(printed: str) -> Failures:
    return [[(name, instant) for name, instant in json.loads(printed)]]


def _lines(tasks: Sequence[Task]) -> Iterator[str]:
    """A line for each task; a ratio only where the failures are those of the first."""
    for task in tasks:
        median = statistics.median(task.wall)
        judged = f"{sum(map(len, task.failures)):,}" if task.read is not None else "–"
        ratio = "–"
        if task is not tasks[0] and task.read is not None:
            alike = task.failures == tasks[0].failures
            ratio = f"{statistics.median(tasks[0].wall) / median:.2f}×" if alike else "–"
            judged += "" if alike else ", others"
        yield (
            f"| {task.what} | {task.who} | {median:.2f} s ({min(task.wall):.2f}–"
            f"{max(task.wall):.2f}) | {statistics.median(task.cpu):.2f} s | {ratio} | {judged} |"
        )
