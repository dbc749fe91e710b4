"""The cost from the file to the verdict: whole processes of rvmon and of others."""

from __future__ import annotations

import gzip
import json
import os
import random
import statistics
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from benchmarks.peers.dialects import translate
from benchmarks.peers.environment import Environment
from benchmarks.process import Cost, measured
from benchmarks.program import in_turn, table
from benchmarks.timing.workload import Size, families, specification

from rvmon.language.print import format_formula

_PEERS = Path(__file__).parents[1] / "peers"
RVMON = (sys.executable, "-m", "rvmon", "run")
JSON = ("--format", "json")
PERIOD = 10_000_000
EACH = 10_000
"""The number of rows of each of many files."""

SMALL = 2_000
"""The number of files of 50 rows."""

SPEC = """spec files
signal speed, obstacle : real
event stop
requirement B1
  always (obstacle < 0.5 -> speed <= 0.3)
requirement B2
  upon stop
  then within 500 ms speed <= 0.05
coverpoint fast = speed {slow: [0, 0.5), fast: [0.5, 2]}
coverpoint near = obstacle {near: [0, 1), far: [1, 20]}
cross both = fast, near
"""


Failures = list[list[tuple[str, int]]]
"""The failed attempts of each report: requirement and instant."""


@dataclass(slots=True)
class Task:
    """A way to judge some files."""

    what: str  # the files that are judged
    who: str  # the program that judges them
    command: Sequence[str]  # must exit with 0 or 1
    read: Callable[[str], Failures]  # the failures from its output
    refusal: str = ""  # why it was not measured
    costs: list[Cost] = field(default_factory=list)  # without the first pass
    found: Failures = field(default_factory=list)  # in the last pass


def measure(tasks: Sequence[Task], repeats: int, folder: Path) -> None:
    """Measure `repeats` passes of all tasks; several follow a first one that fills caches.

    Compiled Python code is kept in the folder, as for an installed package.
    """
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment = {**kept, "PYTHONPYCACHEPREFIX": str(folder / "compiled")}
    is_cold = repeats > 1
    for number, task in in_turn(tasks, repeats + is_cold):
        if task.refusal:
            continue
        cost = measured(task.command, environment=environment)
        if cost.code not in (0, 1):
            task.refusal = cost.said or f"exit code {cost.code}"
            continue
        task.found = task.read(cost.output)
        if number or not is_cold:
            task.costs.append(cost)


def _of_formulas(size: Size, environment: Environment, folder: Path) -> Iterator[Task]:
    """Families of formulas, compared with reelay's C++ by the first violated row."""
    asked = families("process", (("AbsentAQ", 10), ("RespondGLB", 1000)), size.columns)
    for number, workload in enumerate(asked):
        own = folder / f"family{number}"
        own.mkdir()
        spec, path = own / "spec.rv", own / "trace.csv"
        formula = workload.formulas[0]
        spec.write_text(specification([f"always ({format_formula(formula)})"], workload.columns))
        arrays = {name: np.array(column) for name, column in workload.columns.items()}
        table = {"t_ns": np.arange(workload.rows, dtype=np.int64), **arrays}
        cells, head = np.column_stack([*table.values()]), ",".join(table)
        np.savetxt(path, cells, "%d", ",", header=head, comments="")
        if environment.reelay is not None:
            pattern = f"historically({translate(formula, 'REELAY_DISCRETE')})"
            command = (str(environment.reelay), "csv", str(path), pattern)
            yield Task(workload.name, "reelay C++", command, _violated)
        ours: tuple[str, ...] = (*RVMON, str(spec), *JSON)
        yield Task(workload.name, "rvmon run", (*ours, str(path)), _first_failure)
        if find_spec("pyarrow"):
            import pyarrow
            from pyarrow import parquet

            parquet.write_table(pyarrow.table(table), path.with_suffix(".parquet"))
            ours = (*ours, str(path.with_suffix(".parquet")))
            yield Task(workload.name, "rvmon run, Parquet", ours, _first_failure)


def _first_failure(printed: str) -> Failures:
    return [report[:1] for report in _failures(printed, "decided")]


def _violated(printed: str) -> Failures:
    row = int(printed.split()[1])
    return [[] if row < 0 else [("R1", row)]]


def _failures(printed: str, instant: str = "triggered") -> Failures:
    reports = json.loads(printed)
    return [
        sorted(
            (name, attempt[instant])
            for name, entry in report["requirements"].items()
            for attempt in entry["attempts"]
            if attempt["verdict"] == "F"
        )
        for report in (reports if isinstance(reports, list) else [reports])
    ]


def lines(size: Size, environment: Environment) -> Iterator[str]:
    """The table of costs of a robot's files, by files and program."""
    with tempfile.TemporaryDirectory() as name:
        folder, rows = Path(name), list[Sequence[str]]()
        tasks = [*_tasks(size, environment, folder)]
        for what in dict.fromkeys(task.what for task in tasks):
            own = [task for task in tasks if task.what == what]
            measure(own, size.processes, folder)
            there = [task for task in own if not task.refusal]
            rows += [_cells(task, there[0]) for task in there]
    head = ("files", "by", "wall (least to most)", "CPU", "memory", "the first over this")
    yield from table([*head, "failures"], rows)
    refused = (f"{one.who}, {one.what}: {one.refusal}" for one in tasks if one.refusal)
    if told := "; ".join(refused):
        yield from ("", f"Not measured: {told}.")


def _tasks(size: Size, environment: Environment, folder: Path) -> Iterator[Task]:
    rows, spec = size.file_rows, folder / "files.rv"
    spec.write_text(SPEC)

    def judged(what: str, *words: str, how: str = "") -> Task:
        command = (*RVMON, str(spec), *JSON, *words)
        return Task(what, f"rvmon run{how}", command, _failures)

    large = str(written(folder / "large.csv", rows, 0))
    duckdb = "" if "duckdb" in environment.versions else environment.missing.get("duckdb", "none")
    query = (str(environment.python), str(_PEERS / "csv_with_duckdb.py"), large)
    yield Task(f"{rows:,} rows", "DuckDB", query, _told, refusal=duckdb)
    yield judged(f"{rows:,} rows", large)
    yield judged(f"{2 * rows:,} rows", str(written(folder / "larger.csv", 2 * rows, 0)))
    plain, what = written(folder / "plain.csv", rows // 10, 0), f"{rows // 10:,} rows"
    yield judged(what, str(plain))
    for name, path in _odd(plain).items():
        yield judged(what, str(path), how=f", {name}")
    yield judged(what, "--report", str(folder / "page"), str(plain), how=" --report")
    yield judged(what, "--coverage", str(folder / "hits.cov"), str(plain), how=" --coverage")
    many = [str(written(folder / f"file{n:04}.csv", EACH, n)) for n in range(size.files)]
    what = f"{size.files:,} files of {EACH:,} rows"
    yield judged(what, *many)
    yield judged(what, "--jobs", "2", *many, how=" --jobs 2")
    small = [str(written(folder / f"small{n:04}.csv", 50, n)) for n in range(SMALL)]
    yield judged(f"{SMALL:,} files of 50 rows", *small)
    yield judged("10 rows", str(written(folder / "tiny.csv", 10, 0)))
    yield from _of_formulas(size, environment, folder)


def _odd(plain: Path) -> Mapping[str, Path]:
    """Variants of a recording as other programs write it, by their peculiarity."""
    text = plain.read_bytes()
    written = {
        "packed": ("packed.csv.gz", gzip.compress(text, 1)),
        "quoted text in each row": ("quoted.csv", text.replace(b"\n", b',"a ""b"", c"\n')),
        "ends of Windows": ("ends.csv", text.replace(b"\n", b"\r\n")),
    }
    for name, content in written.values():
        plain.with_name(name).write_bytes(content)
    return {what: plain.with_name(name) for what, (name, _) in written.items()}


def written(path: Path, rows: int, seed: int) -> Path:
    """Write a recording of a base whose values change at every row, with occasional failures."""
    rng = random.Random(seed)
    speeds = [f"{0.3 + rng.random():.3f}" for _ in range(997)]
    distances = [f"{0.6 + 10 * rng.random():.2f}" for _ in range(1009)]
    slow, late = -1, rows - 100  # no stop request is open at the end
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


def _told(printed: str) -> Failures:
    return [[(name, instant) for name, instant in json.loads(printed)]]


def _cells(task: Task, first: Task) -> Sequence[str]:
    """A row of the table; a ratio is given only if the failures are those of the first task."""
    wall, cpu = [one.seconds for one in task.costs], [one.cpu for one in task.costs]
    alike = task.found == first.found
    ratio = statistics.median(one.seconds for one in first.costs) / statistics.median(wall)
    count = sum(map(len, task.found))
    return (
        task.what,
        task.who,
        f"{statistics.median(wall):.2f} s ({min(wall):.2f}–{max(wall):.2f})",
        f"{statistics.median(cpu):.2f} s",
        f"{max(one.mebibytes for one in task.costs):.0f} MiB",
        f"{ratio:.2f}×" if alike and task is not first else "–",
        f"{count:,}{'' if alike else ', others'}",
    )
