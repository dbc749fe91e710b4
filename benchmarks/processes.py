"""Whole processes: from a file to the verdict."""

from __future__ import annotations

import resource
import statistics
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from benchmarks.measure import Figure, Result
from benchmarks.ours import always_text, specification
from benchmarks.peers import dialects
from benchmarks.peers.dialects import translate
from benchmarks.peers.native import Native, packed

from benchmarks import timescales


@dataclass(frozen=True, slots=True)
class Program:
    """A command that judges a file.

    Attributes:
        label: who, and what it reads.
        command: exits 0 or 1.
    """

    label: str
    command: tuple[str, ...]


def measure_processes(rows: int, repeats: int, native: Native, folder: Path) -> Iterator[Result]:
    """One family, 1 row in 3 changing, and one with few changes, by every program there is."""
    for name, high in (("AbsentAQ", 10), ("RespondGLB", 1000)):
        family = next(family for family in timescales.FAMILIES if family.name == name)
        columns = timescales.trace(family, high, rows)
        formula = family.past(timescales.low_bound(high), high)
        spec = folder / f"{name}{high}.rv"
        spec.write_text(specification([always_text(formula)], columns, "sampled"))
        files = _files(folder / f"{name}{high}", columns)
        pattern = f"historically({translate(formula, dialects.REELAY_DISCRETE)})"
        programs = list(_programs(spec, files, native, pattern))
        length = len(next(iter(columns.values())))
        figures = tuple(_figures(programs, length, repeats))
        yield Result("process", f"{name} {high}", "past", 1, length, 0.0, figures)


def _files(stem: Path, columns: Mapping[str, list[bool]]) -> dict[str, Path]:
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
        yield Program(f"rvmon run, {kind}", (*run, str(files[kind]), "--format", "json"))
    if native.binary is not None:
        for mode, kind in (("csv", "csv"), ("binary", "bin")):
            yield Program(
                f"reelay C++, {mode}", (str(native.binary), mode, str(files[kind]), pattern)
            )


def _figures(programs: list[Program], rows: int, repeats: int) -> Iterator[Figure]:
    spent: dict[str, list[float]] = {program.label: [] for program in programs}
    for _ in range(repeats):
        for program in programs:
            before = _children()
            done = subprocess.run(program.command, capture_output=True, check=False)
            if done.returncode not in (0, 1):
                raise RuntimeError(f"{program.label}: {done.stderr.decode()[:500]}")
            spent[program.label].append((_children() - before) * 1e9 / rows)
    for label, times in spent.items():
        yield Figure(label, rows, statistics.median(times), min(times), max(times), ())


def _children() -> float:
    """CPU seconds of the processes that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime
