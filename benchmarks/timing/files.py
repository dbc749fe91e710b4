"""What files cost from the file to the verdict: whole processes, ours and others'."""

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
from itertools import islice
from pathlib import Path

import numpy as np
from benchmarks.peers import dialects
from benchmarks.peers.dialects import translate
from benchmarks.peers.environment import Environment, packed
from benchmarks.process import Cost, measured
from benchmarks.timing import suite
from benchmarks.timing.agreement import Agreement, Referee, peers_in
from benchmarks.timing.measure import Result, Size, figure_of, result_of
from benchmarks.timing.race import say
from benchmarks.timing.workload import Column, Workload, always_text, specification

_PEERS = Path(__file__).parents[1] / "peers"
BY_DUCKDB = str(_PEERS / "csv_with_duckdb.py")
BY_PARQUET = str(_PEERS / "parquet_with_reelay.py")
RVMON = (sys.executable, "-m", "rvmon")
PERIOD = 10_000_000
EACH = 10_000
"""Rows of each of many files."""

SMALL = 2_000
"""Files of 50 rows."""

FEW = 50_000
"""Rows of JSON lines."""

SPEC = """spec files
signal speed, obstacle : real
event stop
requirement B1
  always (obstacle < 0.5 -> speed <= 0.3)
requirement B2
  upon stop
  then within 500 ms speed <= 0.05
"""


@dataclass(slots=True)
class Task:
    """A way to judge some files.

    Attributes:
        what: is judged.
        who: judges.
        command: exits 0 or 1.
        read: what was found, from what it prints; `None`: that is not looked at.
        rows: of all files.
        refusal: why it was not measured.
        costs: of the passes that count.
        found: in the last pass.
    """

    what: str
    who: str
    command: Sequence[str]
    read: Callable[[str], object] | None
    rows: int = 1
    refusal: str = ""
    costs: list[Cost] = field(default_factory=list)
    found: object = None

    def run(self, environment: Mapping[str, str], *, counts: bool) -> None:
        """Judge once; one that cannot notes its refusal."""
        cost = measured(self.command, environment=environment)
        if cost.code not in (0, 1):
            self.refusal = cost.said or f"exit code {cost.code}"
            return
        if counts:
            self.costs.append(cost)
        if self.read is not None:
            self.found = self.read(cost.output)


def measure(tasks: Sequence[Task], repeats: int, folder: Path) -> None:
    """So many passes of all tasks in turn, behind a first one that fills caches if several.

    Python keeps in the folder what it has compiled, as an installed package is.
    """
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment = {**kept, "PYTHONPYCACHEPREFIX": str(folder / "compiled")}
    for number in range(-1 if repeats > 1 else 0, repeats):
        for task in tasks:
            if not task.refusal:
                task.run(environment, counts=number >= 0)


def processes(size: Size, environment: Environment) -> tuple[list[Result], list[Agreement]]:
    """Families of formulas, each judged by every program there is, and whether they agree."""
    results, agreements = list[Result](), list[Agreement]()
    with Referee(peers_in(environment), size.traces, size.step_seconds, say) as referee:
        for workload in suite.processed(size.columns):
            say(f"process: {workload.name}")
            with tempfile.TemporaryDirectory() as folder:
                tasks = [*_programs(workload, environment, Path(folder))]
                measure(tasks, size.processes, Path(folder))
            figures = [
                figure_of(
                    one.who,
                    one.rows,
                    [1e9 * cost.cpu for cost in one.costs],
                    (one.found if isinstance(one.found, int) else None,),
                )
                for one in tasks
                if not one.refusal
            ]
            refused = [(one.who, one.refusal) for one in tasks if one.refusal]
            results.append(result_of(workload, figures, refused))
            agreements += referee.check(workload, figures)
    return results, agreements


def _programs(workload: Workload, environment: Environment, folder: Path) -> Iterator[Task]:
    (formula,) = workload.formulas
    columns, rows, stem = workload.columns, workload.rows, folder / "trace"
    spec = folder / "spec.rv"
    spec.write_text(specification([always_text(formula)], columns))
    pattern = f"historically({translate(formula, dialects.REELAY_DISCRETE)})"
    run = (*RVMON, "run", str(spec), "--format", "json")
    files = {
        "csv": (_csv(stem, columns), rows),
        "jsonl": (_jsonl(stem.with_name("few"), columns, FEW), min(rows, FEW)),
        "parquet": (_parquet(stem, columns), rows),
    }
    for form, (path, count) in files.items():
        if path is not None:
            yield Task("", f"rvmon run, {form}", (*run, str(path)), _ours_violated, count)
    if environment.reelay is not None:
        data = stem.with_suffix(".bytes")
        data.write_bytes(packed(columns))
        for mode, path in (("csv", stem.with_suffix(".csv")), ("binary", data)):
            command = (str(environment.reelay), mode, str(path), pattern)
            yield Task("", f"reelay C++, {mode}", command, _reelay_violated, rows)
    parquet = files["parquet"][0]
    if parquet is not None and {"reelay", "pyarrow"} <= set(environment.versions):
        command = (
            str(environment.python),
            BY_PARQUET,
            str(parquet),
            pattern,
        )
        yield Task("", "reelay, parquet", command, _reelay_violated, rows)


def _cells(columns: Mapping[str, Column]) -> Iterator[tuple[bool | float, ...]]:
    return zip(*columns.values(), strict=True)


def _csv(stem: Path, columns: Mapping[str, Column]) -> Path:
    path = stem.with_suffix(".csv")
    with path.open("w") as file:
        file.write("t_ns," + ",".join(columns) + "\n")
        file.writelines(
            f"{t}," + ",".join("1" if cell else "0" for cell in row) + "\n"
            for t, row in enumerate(_cells(columns))
        )
    return path


def _jsonl(stem: Path, columns: Mapping[str, Column], rows: int) -> Path:
    path = stem.with_suffix(".jsonl")
    with path.open("w") as file:
        for t, row in enumerate(islice(_cells(columns), rows)):
            values = {name: bool(cell) for name, cell in zip(columns, row, strict=True)}
            file.write(json.dumps({"t_ns": t, **values}) + "\n")
    return path


def _parquet(stem: Path, columns: Mapping[str, Column]) -> Path | None:
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError:
        return None
    path = stem.with_suffix(".parquet")
    arrays = {name: np.array(column) for name, column in columns.items()}
    rows = len(next(iter(arrays.values())))
    parquet.write_table(pa.table({"t_ns": np.arange(rows, dtype=np.int64), **arrays}), path)
    return path


def _ours_violated(printed: str) -> int | None:
    attempts = json.loads(printed)["requirements"]["R1"]["attempts"]
    rows = [attempt["decided"] for attempt in attempts if attempt["verdict"] == "F"]
    return min(rows, default=None)


def _reelay_violated(printed: str) -> int | None:
    row = int(printed.split()[1])
    return None if row < 0 else row


def table(size: Size, environment: Environment) -> tuple[str, ...]:
    with tempfile.TemporaryDirectory() as folder:
        return tuple(rows(size, environment, Path(folder)))


def rows(size: Size, environment: Environment, folder: Path) -> Iterator[str]:
    yield "| files | by | wall (least to most) | CPU | memory | the first over this | failures |"
    yield "|---|---|---|---|---|---|---|"
    tasks, refused = [*_tasks(size, environment, folder)], list[Task]()
    for what in dict.fromkeys(task.what for task in tasks):
        own = [task for task in tasks if task.what == what]
        measure(own, size.processes, folder)
        refused += [task for task in own if task.refusal]
        yield from _lines([task for task in own if not task.refusal])
    if refused:
        yield ""
        told = "; ".join(f"{task.who}, {task.what}: {task.refusal}" for task in refused)
        yield f"Not measured: {told}."


def _tasks(size: Size, environment: Environment, folder: Path) -> Iterator[Task]:
    rows, spec = size.file_rows, folder / "files.rv"

    def judged(what: str, *words: str, who: str = "rvmon run", text: str = SPEC) -> Task:
        own = spec if text == SPEC else folder / f"{who.split()[-1]}.rv"
        own.write_text(text)
        return Task(what, who, (*RVMON, "run", str(own), "--format", "json", *words), _failures)

    large = str(written(folder / "large.csv", rows, 0))
    duckdb = "" if "duckdb" in environment.versions else environment.missing.get("duckdb", "none")
    query = (str(environment.python), BY_DUCKDB, large)
    yield Task(f"{rows:,} rows", "DuckDB", query, _told, refusal=duckdb)
    yield judged(f"{rows:,} rows", large)
    yield judged(f"{2 * rows:,} rows", str(written(folder / "larger.csv", 2 * rows, 0)))
    plain = written(folder / "plain.csv", rows // 10, 0)
    what = f"{rows // 10:,} rows"
    yield judged(what, str(plain))
    for name, path in _odd(plain).items():
        yield judged(what, str(path), who=f"rvmon run, {name}")
    text = SPEC.replace("event stop", "signal mode : {idle, busy}\nevent stop")
    labelled = str(_with_labels(plain))
    yield judged(what, labelled, who="rvmon run, a column of labels", text=text)
    yield judged(what, "--report", str(folder / "page"), str(plain), who="rvmon run --report")
    hits = ("--coverage", str(folder / "hits.cov"), str(plain))
    yield judged(what, *hits, who="rvmon run --coverage", text=SPEC + COVERED)
    many = [str(written(folder / f"file{n:04}.csv", EACH, n)) for n in range(size.files)]
    what = f"{size.files:,} files of {EACH:,} rows"
    yield judged(what, *many)
    yield judged(what, "--jobs", "2", *many, who="rvmon run --jobs 2")
    small = [str(written(folder / f"small{n:04}.csv", 50, n)) for n in range(SMALL)]
    yield judged(f"{SMALL:,} files of 50 rows", *small)
    yield judged("10 rows", str(written(folder / "tiny.csv", 10, 0)))
    yield Task("10 rows", "rvmon check", (*RVMON, "check", str(spec)), None)


COVERED = """coverpoint fast = speed {slow: [0, 0.5), fast: [0.5, 2]}
coverpoint near = obstacle {near: [0, 1), far: [1, 20]}
cross both = fast, near
"""


def _with_labels(plain: Path) -> Path:
    """The recording with a column of labels."""
    header, *rows = plain.read_text().splitlines()
    path = plain.with_name("labels.csv")
    words = ("idle", "busy")
    lines = (f"{row},{words[number // 7 % 2]}" for number, row in enumerate(rows))
    path.write_text("\n".join([f"{header},mode", *lines, ""]))
    return path


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


def _failures(printed: str) -> list[list[tuple[str, int]]]:
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


def _told(printed: str) -> list[list[tuple[str, int]]]:
    return [[(name, instant) for name, instant in json.loads(printed)]]


def _lines(tasks: Sequence[Task]) -> Iterator[str]:
    """A line for each task; a ratio only where the failures are those of the first."""
    for task in tasks:
        wall, cpu, first = (
            [cost.seconds for cost in task.costs],
            [cost.cpu for cost in task.costs],
            [cost.seconds for cost in tasks[0].costs],
        )
        ratio = count = "–"
        if isinstance(task.found, list):
            count = f"{sum(map(len, task.found)):,}"
        if task is not tasks[0] and task.read is not None:
            alike = task.found == tasks[0].found
            ratio = f"{statistics.median(first) / statistics.median(wall):.2f}×" if alike else "–"
            count += "" if alike else ", others"
        memory = max(cost.mebibytes for cost in task.costs)
        yield (
            f"| {task.what} | {task.who} | {statistics.median(wall):.2f} s ({min(wall):.2f}–"
            f"{max(wall):.2f}) | {statistics.median(cpu):.2f} s | {memory:.0f} MiB | {ratio} | "
            f"{count} |"
        )
