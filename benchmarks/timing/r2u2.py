"""R2U2's C monitor, built from a clone of its repository for the formulas of each workload.

C2PO compiles the formulas with its defaults, and R2U2's C is compiled with the sizes that C2PO
writes, and -O3. A loop passes over bytes in memory. R2U2 reports that a formula is false at the
last row of its window, rvmon when the window is over, one row later.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.peers.client import PeerError
from benchmarks.peers.dialects import spelling, translate
from benchmarks.peers.ways import Question
from benchmarks.timing.race import Contender, Pass, passed
from benchmarks.timing.workload import Workload
from tests.tools.common_fragment import UntranslatableError

LOOP = Path(__file__).parents[1] / "peers" / "r2u2_native" / "loop.c"


@dataclass
class R2u2(Contender):
    """R2U2 as a contender; it is built for one workload at a time."""

    source: Path  # the clone
    label: str = "R2U2 C, memory"
    folder: Path = field(default_factory=lambda: Path(tempfile.mkdtemp()))  # for build products
    built_for: str = ""  # the name of the workload
    names: Sequence[str] = ()  # the names of the columns
    sizes: tuple[str, ...] = ()
    is_asked = True

    def prepare(self, workload: Workload, rows: int) -> None:
        """Build the monitor for the workload if needed, and write the rows.

        Raises:
            UntranslatableError: its language cannot express a formula.
            PeerError: the build fails.
        """
        if workload.form != "future":
            raise UntranslatableError("only future forms are measured")
        if self.built_for != workload.name:
            try:
                self._build(workload)
            except subprocess.CalledProcessError as error:
                raise PeerError((error.stderr or "it does not compile").splitlines()[-1]) from None
            self.built_for, self.names = workload.name, list(workload.columns)
        columns = [column[:rows] for column in workload.columns.values()]
        self.sizes = str(len(columns)), str(len(workload.formulas))
        (self.folder / "rows").write_bytes(
            bytes(bool(cell) for row in zip(*columns, strict=True) for cell in row)
        )

    def run(self) -> Pass:
        own = self.folder
        return passed([own / "loop", own / "spec.bin", own / "rows", *self.sizes], later=1)

    def truths(self, question: Question) -> Sequence[bool | None]:
        """The verdicts of the first formula."""
        nothing = [False] * question.ticks
        columns = [question.columns.get(name, nothing) for name in self.names]
        path = self.folder / "rows.csv"
        rows = zip(*columns, strict=True)
        path.write_text(
            "".join(",".join(str(int(bool(cell))) for cell in row) + "\n" for row in rows)
        )
        found: list[bool | None] = []
        for line in _run(self.folder / "r2u2", self.folder / "spec.bin", path).splitlines():
            number, _, said = line.partition(":")
            row, _, truth = said.partition(",")
            if number == "0":  # for equal consecutive verdicts only the last row is printed
                found += [truth == "T"] * (int(row) + 1 - len(found))
        return found + [None] * (question.ticks - len(found))

    def _build(self, workload: Workload) -> None:
        names = list(workload.columns)
        inputs = f"INPUT\n    {', '.join(map(spelling, names))}: bool;\n\nFTSPEC\n"
        lines = "".join(f"    {translate(one, 'C2PO')};\n" for one in workload.formulas)
        text, mapping, bounds = (
            self.folder / name for name in ("formulas.c2po", "names.map", "bounds.h")
        )
        text.write_text(inputs + lines)
        mapping.write_text("".join(f"{spelling(name)}:{i}\n" for i, name in enumerate(names)))
        _run(
            *(sys.executable, self.source / "compiler" / "c2po.py", "--quiet", "--spec", text),
            *("--map", mapping, "--output", self.folder / "spec.bin", "--write-bounds", bounds),
        )
        # C2PO counts only the signals that are read, but all are loaded; and sizes must not be 0.
        tight = re.compile(r"(?<=R2U2_MAX_)(SIGNALS|ATOMICS|BZ_INSTRUCTIONS) \d+")
        bounds.write_text(tight.sub(rf"\1 {len(names)}", bounds.read_text()))
        code = self.source / "monitors" / "c" / "src"
        parts = [path for path in sorted(code.rglob("*.c")) if path.parent.name != "cli"]
        includes = [word for path in code.rglob("*/") for word in ("-I", path)]
        flags = ["gcc", "-O3", "-w", "-std=gnu11", "-include", bounds, "-I", code, *includes]
        _run(*flags, LOOP, *parts, "-o", self.folder / "loop", "-lm")
        _run(*flags, *(code / "cli").glob("*.c"), *parts, "-o", self.folder / "r2u2", "-lm")


def _run(*command: str | Path) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout
