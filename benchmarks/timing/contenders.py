"""Who is measured, and how each is given a workload."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from benchmarks.peers import dialects
from benchmarks.peers.client import Peer
from benchmarks.peers.dialects import Dialect, spelling, translate
from benchmarks.peers.environment import HOME, Environment
from benchmarks.peers.native import LETTERS, Native, packed
from benchmarks.timing.workload import Workload, always_text, specification, text
from tests.tools.build import scaled
from tests.tools.common_fragment import UntranslatableError

OURS = Path(__file__).parents[1] / "peers" / "with_rvmon.py"
"""The module that asks our own monitors."""


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
    """A contender behind the protocol of the peers."""

    label: str
    peer: Peer
    request: Request

    def prepare(self, workload: Workload, rows: int) -> None:
        """Send the formulas and the rows."""
        self.peer.ask("load", **self.request(workload, rows))

    def run(self) -> Pass:
        """One pass in the worker's process; it measures itself."""
        answer = self.peer.ask("run")
        return Pass(answer["cpu_ns"], tuple(answer["violated"]))

    def close(self) -> None:
        """End the process: it holds the rows."""
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
        patterns = [f"historically({p})" for p in _translated(workload, dialects.REELAY_DISCRETE)]
        self.command = [str(self.binary), "memory", str(path), *patterns, "1"]

    def run(self) -> Pass:
        """One pass in a process of its own; it measures the loop alone."""
        done = subprocess.run(self.command, capture_output=True, text=True, check=True)
        spent, *violated = (int(word) for word in done.stdout.split())
        return Pass(spent, tuple(None if row < 0 else row for row in violated))

    def close(self) -> None:
        """Nothing is held."""


STEPS = (("rvmon step", "step"), ("rvmon step, changes", "changes"))
COLUMNS = (("rvmon evaluate", "evaluate"),)
MARGINS = (
    ("rvmon, each sample", "stream"),
    ("rvmon, one attempt", "attempt"),
    ("rvmon offline", "offline"),
)
"""Robustness: of each sample, of what is required from the first one on, and of columns."""


def contenders(environment: Environment, native: Native, section: str) -> Iterator[Contender]:
    """All that take part in a section, ours first: with columns in memory, or row by row."""
    forms = {"batch": COLUMNS, "margins": MARGINS}.get(section, STEPS)
    for label, kind in forms:
        yield Worker(label, Peer(Path(sys.executable), OURS), _ours(kind))
    if section == "margins":
        for kind in ("", " offline") if "sentil" in environment.versions else ():
            yield Worker(f"sentil{kind}", Peer(environment.python, "sentil"), _margins(kind))
        return
    peers: tuple[tuple[str, str, str, Request], ...] = (
        ("reelay", "reelay", "reelay", _up_to(100, _past(dialects.REELAY_DISCRETE))),
        ("rtamt", "rtamt", "rtamt", _up_to(10, _past(dialects.RTAMT_DISCRETE))),
        ("mstlo", "mstlo-python", "mstlo", _up_to(100, _future_of_mstlo)),
        ("sentil", "sentil", "sentil", _of_sentil),
    )
    for label, package, worker, request in peers:
        if package in environment.versions:
            yield Worker(label, Peer(environment.python, worker), request)
    if native.binary is not None and section == "batch":
        yield NativeReelay(native.binary)


def _ours(kind: str) -> Request:
    def request(workload: Workload, rows: int) -> dict[str, Any]:
        columns = {name: list(column[:rows]) for name, column in workload.columns.items()}
        if workload.section == "margins":
            spec = margin_text(workload)
        else:
            texts = [always_text(scaled(f, workload.period)) for f in workload.formulas]
            spec = specification(texts, columns)
        period = 1 if workload.section == "margins" else workload.period
        return {"spec": spec, "kind": kind, "columns": columns, "rows": rows, "period": period}

    return request


def margin_text(workload: Workload) -> str:
    """A formula as it is required from the first sample on, a tick between two samples."""
    required = f"upon start\n  then {text(workload.formulas[0])}"
    return specification([required], workload.columns).replace("time held", "time sampled")


def _margins(kind: str) -> Request:
    def request(workload: Workload, rows: int) -> dict[str, Any]:
        formulas = _translated(workload, dialects.SENTIL)
        return _rows(workload, rows, formulas, f"discrete{kind}")

    return request


def _past(dialect: Dialect) -> Request:
    def request(workload: Workload, rows: int) -> dict[str, Any]:
        if workload.form != "past":
            raise UntranslatableError("only past forms are measured")
        formulas = [f"historically({f})" for f in _translated(workload, dialect)]
        return _rows(workload, rows, formulas, "discrete")

    return request


def _up_to(most: int, request: Request) -> Request:
    """Refuse more formulas: passing over a few rows, or making the monitors, takes too long."""

    def limited(workload: Workload, rows: int) -> dict[str, Any]:
        if len(workload.formulas) > most:
            raise UntranslatableError(f"too slow to be measured with more than {most} formulas")
        return request(workload, rows)

    return limited


def _future_of_mstlo(workload: Workload, rows: int) -> dict[str, Any]:
    return _rows(workload, rows, _future(workload, dialects.MSTLO), "DelayedQualitative")


def _of_sentil(workload: Workload, rows: int) -> dict[str, Any]:
    formulas = [f"always[0, inf]({f})" for f in _translated(workload, dialects.SENTIL)]
    return _rows(workload, rows, formulas, "discrete")


def _future(workload: Workload, dialect: Dialect) -> list[str]:
    if workload.form != "future":
        raise UntranslatableError("only future forms are measured")
    return _translated(workload, dialect)


def _translated(workload: Workload, dialect: Dialect) -> list[str]:
    return [translate(formula, dialect) for formula in workload.formulas]


def _rows(workload: Workload, rows: int, formulas: list[str], kind: str) -> dict[str, Any]:
    columns = {spelling(name): list(column[:rows]) for name, column in workload.columns.items()}
    return {"formulas": formulas, "kind": kind, "columns": columns, "rows": rows}
