"""Who is measured, and how each is given a workload."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, Protocol

from benchmarks.peers import dialects
from benchmarks.peers.client import ADAPTERS, Peer
from benchmarks.peers.dialects import spelling, translate
from benchmarks.peers.environment import HOME, LETTERS, Environment, packed
from benchmarks.peers.ways import WAYS, Way
from benchmarks.timing.workload import Workload, always_text, specification
from tests.tools.build import scaled
from tests.tools.common_fragment import UntranslatableError

from rvmon.spec.print import format_formula


@dataclass(frozen=True, slots=True)
class Pass:
    """One pass over a workload: CPU ns, and per formula the first row at which it was violated."""

    cpu_ns: int
    violated: tuple[int | None, ...]


class Contender(Protocol):
    """Someone who can be given a workload and passes over it again and again."""

    label: str

    def prepare(self, workload: Workload, rows: int) -> None:
        """Take the first so many rows; raise `UntranslatableError` if that cannot be done."""

    def run(self) -> Pass:
        """One pass."""

    def close(self) -> None:
        """Free what was taken."""


Request = Callable[[Workload, int], dict[str, Any]]


@dataclass(slots=True)
class Worker:
    """A contender in a process of its own, which holds the rows and measures itself."""

    label: str
    peer: Peer
    request: Request

    def prepare(self, workload: Workload, rows: int) -> None:
        self.peer.ask("load", **self.request(workload, rows))

    def run(self) -> Pass:
        answer = self.peer.ask("run")
        return Pass(answer["cpu_ns"], tuple(answer["violated"]))

    def close(self) -> None:
        self.peer.close()


@dataclass(slots=True)
class NativeReelay:
    """reelay's C++ monitor over bytes in memory."""

    binary: Path
    label: str = "reelay C++"
    command: list[str] = field(default_factory=list)

    def prepare(self, workload: Workload, rows: int) -> None:
        """Write the rows to a file, from which each pass reads them first."""
        if not set(workload.columns) <= set(LETTERS):
            raise UntranslatableError("its harness knows the columns p, q, r, s")
        path = HOME / "rows.bin"
        columns = {name: column[:rows] for name, column in workload.columns.items()}
        path.write_bytes(packed(columns))
        patterns = [
            f"historically({translate(formula, dialects.REELAY_DISCRETE)})"
            for formula in workload.formulas
        ]
        self.command = [str(self.binary), "memory", str(path), *patterns, "1"]

    def run(self) -> Pass:
        """One pass in a process of its own; it measures the loop alone."""
        done = subprocess.run(self.command, capture_output=True, text=True, check=True)
        spent, *violated = (int(word) for word in done.stdout.split())
        return Pass(spent, tuple(None if row < 0 else row for row in violated))

    def close(self) -> None:
        """Nothing is held."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A peer that takes part.

    Attributes:
        label: as it stands in the tables.
        way: how it is asked.
        form: the only form of formulas that is measured; empty: both.
        required: how a formula is demanded at every row.
        most: with more formulas, passing over a few rows, or making the monitors, takes too long.
    """

    label: str
    way: Way
    form: str = ""
    required: str = "{}"
    most: int = 1_000

    def request(self, workload: Workload, rows: int) -> dict[str, Any]:
        """What its process is asked to load."""
        if self.form not in ("", workload.form):
            raise UntranslatableError(f"only {self.form} forms are measured")
        formulas = [translate(formula, self.way.dialect) for formula in workload.formulas]
        if len(formulas) > self.most:
            text = f"too slow to be measured with more than {self.most} formulas"
            raise UntranslatableError(text)
        columns = {spelling(name): list(one[:rows]) for name, one in workload.columns.items()}
        required = [self.required.format(one) for one in formulas]
        return {"formulas": required, "kind": self.way.kind, "columns": columns, "rows": rows}


PEERS = (
    Entry("reelay", WAYS["reelay-discrete"], "past", "historically({})", 100),
    Entry("rtamt", WAYS["rtamt-discrete"], "past", "historically({})", 10),
    Entry("mstlo", WAYS["mstlo-delayed"], "future", most=100),
    Entry("sentil", WAYS["sentil"], required="always[0, inf]({})"),
)
MEASURED = (
    Entry("sentil", WAYS["sentil"]),
    Entry("sentil offline", replace(WAYS["sentil"], kind="discrete offline")),
)
"""Of robustness."""

OURS = {
    "batch": {"rvmon evaluate": "evaluate"},
    "margins": {
        "rvmon, each sample": "stream",
        "rvmon, one attempt": "attempt",
        "rvmon offline": "offline",
    },
}
"""By section; robustness of each sample, of what is required from the first on, of columns."""

STEPPED = {"rvmon step": "step", "rvmon step, changes": "changes"}


def contenders(environment: Environment, section: str) -> Iterator[Contender]:
    """All that take part in a section, ours first: with columns in memory, or row by row."""
    own = ADAPTERS.with_name("ours.py")
    for label, kind in OURS.get(section, STEPPED).items():
        yield Worker(label, Peer(Path(sys.executable), "Rvmon", own), partial(_ours, kind))
    for entry in MEASURED if section == "margins" else PEERS:
        if entry.way.package in environment.versions:
            yield Worker(entry.label, Peer(environment.python, entry.way.adapter), entry.request)
    if environment.reelay is not None and section == "batch":
        yield NativeReelay(environment.reelay)


def _ours(kind: str, workload: Workload, rows: int) -> dict[str, Any]:
    columns = {name: list(column[:rows]) for name, column in workload.columns.items()}
    if workload.section == "margins":
        return {"spec": margin_text(workload), "kind": kind, "columns": columns, "rows": rows}
    texts = [always_text(scaled(formula, workload.period)) for formula in workload.formulas]
    spec = specification(texts, columns)
    period = workload.period
    return {"spec": spec, "kind": kind, "columns": columns, "rows": rows, "period": period}


def margin_text(workload: Workload) -> str:
    """A formula as it is required from the first sample on, a tick between two samples."""
    required = f"upon start\n  then {format_formula(workload.formulas[0])}"
    return specification([required], workload.columns).replace("time held", "time sampled")
