"""Many monitors beside R2U2, whose C monitor is built from its repository.

    git clone https://github.com/R2U2/r2u2 r2u2
    python -m benchmarks.r2u2 r2u2 [--rows 25000]     (or, in the whole run: --r2u2 r2u2)

Responses in their future form on one stream of 20 signals, of which one changes at each row, as in
the section `many` of the whole run; C2PO compiles them as it does by itself, and R2U2's C gets the
sizes that C2PO writes, and -O3. `memory`: its loop over bytes, ours over columns; `rvmon step` is
called from Python. Each formula's verdict at each row is compared, and when each was first false in
what is timed: R2U2 reports that at the last row of a window, ours when it is over, one row later.
CPU time per row: the median of the passes with the least and the most.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.contenders import COLUMNS, STEPS, Contender, Pass, our_worker
from benchmarks.measure import Plan, measure
from benchmarks.peers.dialects import Dialect, spelling, translate
from benchmarks.peers.positions import Question, answers, ask_monitor
from benchmarks.results import ratio_text, time_text
from benchmarks.workload import Workload

from benchmarks import suite
from rvmon.spec.checked.formula import BinaryOp, UnaryOp
from rvmon.spec.checked.specification import TimeModel

LOOP = Path(__file__).parent / "peers" / "r2u2_native" / "loop.c"
MEMORY = "R2U2 C, memory"
COMPARED_ROWS = 2_000

C2PO = Dialect(
    "c2po",
    lambda name: name,
    None,
    ("(!({0}))", "(({0}) && ({1}))", "(({0}) || ({1}))"),
    {UnaryOp.EVENTUALLY: "(F{bound}({0}))", UnaryOp.ALWAYS: "(G{bound}({0}))"},
    {BinaryOp.UNTIL: "(({0}) U{bound} ({1}))"},
    lambda low, high: f"[{low},{high}]",
    ever=False,
)


@dataclass(frozen=True, slots=True)
class Built:
    """R2U2 for the formulas of one workload.

    Attributes:
        specification: that C2PO made.
        loop: goes over rows in memory.
        command: R2U2's own program, which reads CSV.
    """

    specification: Path
    loop: Path
    command: Path


def built(workload: Workload, source: Path, folder: Path) -> Built:
    """Compile the formulas, and R2U2 with the room that they need.

    Raises:
        subprocess.CalledProcessError: a compiler failed.
    """
    names = list(workload.columns)
    inputs = f"INPUT\n    {', '.join(map(spelling, names))}: bool;\n\nFTSPEC\n"
    lines = "".join(f"    {translate(one, C2PO)};\n" for one in workload.formulas)
    text, mapping, bounds = folder / "formulas.c2po", folder / "names.map", folder / "bounds.h"
    made = Built(folder / "spec.bin", folder / "loop", folder / "r2u2")
    text.write_text(inputs + lines)
    mapping.write_text("".join(f"{spelling(name)}:{i}\n" for i, name in enumerate(names)))
    _run(
        *(sys.executable, source / "compiler" / "c2po.py", "--quiet", "--spec", text, "--map"),
        *(mapping, "--output", made.specification, "--write-bounds", bounds),
    )
    # C2PO counts the signals that are read; all are loaded, and of nothing there is one.
    tight = re.compile(r"(?<=R2U2_MAX_)(SIGNALS|ATOMICS|BZ_INSTRUCTIONS) \d+")
    bounds.write_text(tight.sub(rf"\1 {len(names)}", bounds.read_text()))
    code = source / "monitors" / "c" / "src"
    parts = [path for path in sorted(code.rglob("*.c")) if path.parent.name != "cli"]
    includes = [word for path in code.rglob("*/") for word in ("-I", path)]
    flags = ["gcc", "-O3", "-w", "-std=gnu11", "-include", bounds, "-I", code, *includes]
    _run(*flags, LOOP, *parts, "-o", made.loop, "-lm")
    _run(*flags, *sorted((code / "cli").glob("*.c")), *parts, "-o", made.command, "-lm")
    return made


def _run(*command: str | Path) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


@dataclass(slots=True)
class Memory:
    """R2U2's monitor over rows in memory, in a process that measures its loop alone."""

    made: Built
    rows: Path
    label: str = MEMORY
    command: tuple[str, ...] = ()

    def prepare(self, workload: Workload, rows: int) -> None:
        """Write the rows."""
        columns = [column[:rows] for column in workload.columns.values()]
        self.rows.write_bytes(
            bytes(bool(cell) for row in zip(*columns, strict=True) for cell in row)
        )
        sizes = str(len(columns)), str(len(workload.formulas))
        self.command = (str(self.made.loop), str(self.made.specification), str(self.rows), *sizes)

    def run(self) -> Pass:
        """One pass."""
        spent, *violated = map(int, _run(*self.command).split())
        return Pass(spent, tuple(None if row < 0 else row + 1 for row in violated))

    def close(self) -> None:
        """Nothing is held."""


def compared(workload: Workload, made: Built, folder: Path) -> tuple[int, int, int]:
    """Verdicts that are equal, of how many, and ours that are FALSE among them."""
    columns = {name: column[:COMPARED_ROWS] for name, column in workload.columns.items()}
    path = folder / "rows.csv"
    cells = zip(*columns.values(), strict=True)
    path.write_text("".join(",".join(str(int(cell)) for cell in row) + "\n" for row in cells))
    theirs: list[list[bool]] = [[] for _ in workload.formulas]
    for line in _run(made.command, made.specification, path).splitlines():
        number, _, verdict = line.partition(":")
        row, _, truth = verdict.partition(",")
        own = theirs[int(number)]  # of rows that are alike the last one is printed
        own += [truth == "T"] * (int(row) + 1 - len(own))
    equal = count = false = 0
    for formula, other in zip(workload.formulas, theirs, strict=True):
        question = Question(formula, columns, frozenset(), TimeModel.HELD)
        for answer, verdict in zip(answers(question, ask_monitor), other, strict=False):
            if answer is not None:
                count, equal, false = count + 1, equal + (answer is verdict), false + (not answer)
    return equal, count, false


def figures(workload: Workload, source: Path, plan: Plan, folder: Path) -> Iterator[str]:
    """The lines of one workload."""
    made = built(workload, source, folder)
    equal, count, false = compared(workload, made, folder)
    contenders: list[Contender] = [
        our_worker(label, kind) for label, kind in (*STEPS, *COLUMNS) if kind != "changes"
    ]
    contenders.append(Memory(made, folder / "rows.bin"))
    result = measure(workload, contenders, plan)
    for contender in contenders:
        contender.close()
    peer = next(one for one in result.figures if one.label == MEMORY)
    for one in result.figures:
        alike = one.rows != peer.rows or one.violated == peer.violated
        ratio = ratio_text(peer.median / one.median) if alike and equal == count else "they differ"
        spread = f"{time_text(one.least)}–{time_text(one.most)}"
        yield (
            f"| {workload.name} | {one.label} | {time_text(one.median)} ({spread}), {one.rows:,} "
            f"rows | {ratio} |"
        )
    yield f"| {workload.name} | verdicts equal | {equal:,} of {count:,}, {false:,} FALSE | |"
    for label, why in result.refusals:
        yield f"| {workload.name} | {label} | {why} | |"


def table(source: Path, rows: int, counts: Sequence[int]) -> Iterator[str]:
    """The lines for so many monitors.

    Args:
        source: a clone of R2U2's repository.
        rows: of the stream.
        counts: of monitors.
    """
    yield "| workload | who | CPU per row | R2U2's over it |"
    yield "|---|---|---|---|"
    for workload in suite.many(rows, counts):
        if workload.form == "future":
            with tempfile.TemporaryDirectory() as folder:
                yield from figures(workload, source, Plan(5, 1.0), Path(folder))


def main(argv: Sequence[str]) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Many monitors beside R2U2's C monitor.")
    parser.add_argument("source", type=Path, help="a clone of R2U2's repository")
    parser.add_argument("--rows", type=int, default=25_000)
    parser.add_argument("--counts", type=int, nargs="+", default=[10, 100, 1000])
    options = parser.parse_args(argv)
    for line in table(options.source, options.rows, options.counts):
        print(line, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
