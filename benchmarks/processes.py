"""Whole processes: from a file to the verdict."""

from __future__ import annotations

import json
import os
import resource
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from benchmarks.measure import Figure, Result
from benchmarks.ours import always_text, specification
from benchmarks.peers import dialects
from benchmarks.peers.dialects import translate
from benchmarks.peers.environment import Environment
from benchmarks.peers.native import Native, packed
from benchmarks.workload import Column, Workload

BY_PARQUET = Path(__file__).parent / "peers" / "parquet_with_reelay.py"
FEW = 50_000
"""Rows for what judges row by row in Python."""


@dataclass(frozen=True, slots=True)
class Program:
    """A command that judges a file.

    Attributes:
        label: who, and what it reads.
        command: exits 0 or 1.
        violated: reads the first violated row from what it prints.
        rows: of the file.
    """

    label: str
    command: tuple[str, ...]
    violated: Callable[[str], int | None]
    rows: int


def measure_process(
    workload: Workload, repeats: int, environment: Environment, native: Native, folder: Path
) -> Result:
    """Judge a workload's only formula by every program there is, from files in the folder."""
    (formula,) = workload.formulas
    spec = folder / "spec.rv"
    spec.write_text(specification([always_text(formula)], workload.columns))
    pattern = f"historically({translate(formula, dialects.REELAY_DISCRETE)})"
    stem = folder / "trace"
    programs = [*_ours(spec, stem, workload), *_peers(stem, pattern, workload, environment, native)]
    figures, refusals = _figures(programs, repeats, as_installed(folder))
    return Result(
        workload.section,
        workload.name,
        workload.form,
        1,
        workload.rows,
        workload.changing,
        tuple(figures),
        tuple(refusals),
    )


def _ours(spec: Path, stem: Path, workload: Workload) -> Iterator[Program]:
    columns, rows = workload.columns, workload.rows
    csv = _csv(stem, columns)
    rvmon = (sys.executable, "-m", "rvmon")
    run = (*rvmon, "run", str(spec))
    judged = (*run, str(csv), "--format", "json")
    few = str(_jsonl(stem.with_name("few"), columns, FEW))
    yield Program("rvmon run, csv", judged, _ours_violated, rows)
    yield Program(
        "rvmon run, jsonl", (*run, few, "--format", "json"), _ours_violated, min(rows, FEW)
    )
    parquet = _parquet(stem, columns)
    if parquet is not None:
        judged = (*run, str(parquet), "--format", "json")
        yield Program("rvmon run, parquet", judged, _ours_violated, rows)


def _peers(
    stem: Path, pattern: str, workload: Workload, environment: Environment, native: Native
) -> Iterator[Program]:
    rows = workload.rows
    if native.binary is not None:
        data = stem.with_suffix(".bytes")
        data.write_bytes(packed(workload.columns))
        for mode, path in (("csv", stem.with_suffix(".csv")), ("binary", data)):
            command = (str(native.binary), mode, str(path), pattern)
            yield Program(f"reelay C++, {mode}", command, _reelay_violated, rows)
    parquet = stem.with_suffix(".parquet")
    if parquet.exists() and {"reelay", "pyarrow"} <= set(environment.versions):
        command = (str(environment.python), str(BY_PARQUET), str(parquet), pattern)
        yield Program("reelay, parquet", command, _reelay_violated, rows)


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


def as_installed(folder: Path) -> dict[str, str]:
    """The environment in which Python keeps what it has compiled, as an installed package is."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return {**kept, "PYTHONPYCACHEPREFIX": str(folder / "compiled")}


def _figures(
    programs: list[Program], repeats: int, environment: Mapping[str, str]
) -> tuple[list[Figure], list[tuple[str, str]]]:
    """Figures of the programs that work, and what the others said."""
    spent: dict[str, list[float]] = {program.label: [] for program in programs}
    violated: dict[str, int | None] = {}
    refusals: list[tuple[str, str]] = []
    for number in range(-1, repeats):  # the first round fills caches and does not count
        for program in list(programs):
            before = _children()
            done = subprocess.run(
                program.command, capture_output=True, text=True, check=False, env=environment
            )
            if done.returncode not in (0, 1):
                said = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
                refusals.append((program.label, said[-1]))
                programs.remove(program)
                continue
            if number >= 0:
                spent[program.label].append((_children() - before) * 1e9 / program.rows)
            violated[program.label] = program.violated(done.stdout)
    figures = [
        Figure(
            program.label,
            program.rows,
            statistics.median(spent[program.label]),
            min(spent[program.label]),
            max(spent[program.label]),
            (violated[program.label],),
        )
        for program in programs
    ]
    return figures, refusals


def _children() -> float:
    """CPU seconds of the processes that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime
