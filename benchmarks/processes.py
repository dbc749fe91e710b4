"""Whole processes: from a file to the verdict."""

from __future__ import annotations

import json
import resource
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from benchmarks.measure import Figure, Result
from benchmarks.ours import always_text, specification
from benchmarks.peers.native import Native, packed
from benchmarks.workload import Column, Workload

from rvmon.testing.peers import dialects
from rvmon.testing.peers.dialects import translate


@dataclass(frozen=True, slots=True)
class Program:
    """A command that judges a file.

    Attributes:
        label: who, and what it reads.
        command: exits 0 or 1.
        violated: reads the first violated row from what it prints.
    """

    label: str
    command: tuple[str, ...]
    violated: Callable[[str], int | None]


def measure_process(workload: Workload, repeats: int, native: Native, folder: Path) -> Result:
    """Judge a workload's only formula by every program there is, from files in the folder."""
    (formula,) = workload.formulas
    spec = folder / "spec.rv"
    spec.write_text(specification([always_text(formula)], workload.columns))
    files = _files(folder / "trace", workload.columns)
    pattern = f"historically({translate(formula, dialects.REELAY_DISCRETE)})"
    programs = list(_programs(spec, files, native, pattern))
    return Result(
        workload.section,
        workload.name,
        workload.form,
        1,
        workload.rows,
        workload.changing,
        tuple(_figures(programs, workload.rows, repeats)),
    )


def _files(stem: Path, columns: Mapping[str, Column]) -> dict[str, Path]:
    """The same rows as CSV, JSON lines and bytes."""
    names = list(columns)
    cells = list(zip(*columns.values(), strict=True))
    files = {kind: stem.with_suffix(f".{kind}") for kind in ("csv", "jsonl", "bin")}
    with files["csv"].open("w") as csv:
        csv.write("t_ns," + ",".join(names) + "\n")
        csv.writelines(
            f"{t}," + ",".join("1" if cell else "0" for cell in row) + "\n"
            for t, row in enumerate(cells)
        )
    with files["jsonl"].open("w") as jsonl:
        for t, row in enumerate(cells):
            values = ", ".join(
                f'"{name}": {"true" if cell else "false"}'
                for name, cell in zip(names, row, strict=True)
            )
            jsonl.write(f'{{"t_ns": {t}, {values}}}\n')
    files["bin"].write_bytes(packed(columns))
    return files


def _programs(
    spec: Path, files: Mapping[str, Path], native: Native, pattern: str
) -> Iterator[Program]:
    run = (sys.executable, "-m", "rvmon", "run", str(spec))
    for kind in ("csv", "jsonl"):
        judged = (*run, str(files[kind]), "--format", "json")
        yield Program(f"rvmon run, {kind}", judged, _ours_violated)
    if native.binary is not None:
        for mode, kind in (("csv", "csv"), ("binary", "bin")):
            command = (str(native.binary), mode, str(files[kind]), pattern)
            yield Program(f"reelay C++, {mode}", command, _reelay_violated)


def _ours_violated(printed: str) -> int | None:
    attempts = json.loads(printed)["requirements"]["R1"]["attempts"]
    rows = [attempt["decided"] for attempt in attempts if attempt["verdict"] == "F"]
    return min(rows, default=None)


def _reelay_violated(printed: str) -> int | None:
    row = int(printed.split()[1])
    return None if row < 0 else row


def _figures(programs: list[Program], rows: int, repeats: int) -> Iterator[Figure]:
    spent: dict[str, list[float]] = {program.label: [] for program in programs}
    violated: dict[str, int | None] = {}
    for _ in range(repeats):
        for program in programs:
            before = _children()
            done = subprocess.run(program.command, capture_output=True, text=True, check=False)
            if done.returncode not in (0, 1):
                raise RuntimeError(f"{program.label}: {done.stderr[:500]}")
            spent[program.label].append((_children() - before) * 1e9 / rows)
            violated[program.label] = program.violated(done.stdout)
    for label, times in spent.items():
        yield Figure(
            label, rows, statistics.median(times), min(times), max(times), (violated[label],)
        )


def _children() -> float:
    """CPU seconds of the processes that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime
