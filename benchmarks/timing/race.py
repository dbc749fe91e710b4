"""Time contenders in alternating passes, so that slow phases of the machine affect all alike."""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from benchmarks.peers.client import ADAPTERS, Peer, PeerError
from benchmarks.peers.dialects import spelling, translate
from benchmarks.peers.environment import HOME, LETTERS, Environment, packed
from benchmarks.peers.ways import RTAMT_STEPPED, WAYS, Question, Way
from benchmarks.program import in_turn
from benchmarks.timing.workload import Workload, specification
from tests.tools.build import scaled
from tests.tools.common_fragment import UntranslatableError

from rvmon.language.print import format_formula

FEWEST_ROWS = 50
"""The minimum number of rows of a pass, also for a first estimate of the speed."""

SLOW = 10
"""A contender whose pass takes this many times the planned time makes only two passes."""

LONGER = {"batch": 10, "many": 5}
"""Factors for the length of passes in sections with batch evaluation or a slow start."""


@dataclass(frozen=True, slots=True)
class Pass:
    """One pass over a workload: CPU ns, and the first violated row of each formula."""

    cpu_ns: int
    violated: tuple[int | None, ...]


@dataclass(frozen=True, slots=True)
class Figure:
    """The cost of one workload for one contender."""

    label: str  # the contender
    rows: int  # per pass
    median: float  # CPU ns per row
    least: float  # of all passes
    most: float  # of all passes
    violated: tuple[int | None, ...]  # the first violated row of each formula


@dataclass(frozen=True, slots=True)
class Result:
    """All figures of one workload."""

    section: str  # the table
    name: str  # the line
    form: str  # `past` or `future`
    rows: int  # of the whole trace
    changing: float  # the share of rows at which something changes
    figures: tuple[Figure, ...]  # of the contenders that took part
    refusals: tuple[tuple[str, str], ...] = ()  # label and reason of the others


class Contender(ABC):
    """A program that can pass over a workload repeatedly."""

    label: str
    is_asked = False  # whether `truths` is available

    @abstractmethod
    def prepare(self, workload: Workload, rows: int) -> None:
        """Load the first rows; raise `UntranslatableError` if a formula cannot be expressed."""

    @abstractmethod
    def run(self) -> Pass:
        """One pass."""

    def truths(self, question: Question) -> Sequence[bool | None]:
        """The verdict at each row, if `is_asked`."""
        raise NotImplementedError


class Worker(Contender):
    """A contender in a separate process, which holds the rows and measures its own time."""

    peer: Peer

    def run(self) -> Pass:
        answer = self.peer.ask("run")
        return Pass(answer["cpu_ns"], tuple(answer["violated"]))

    def close(self) -> None:
        self.peer.close()


@dataclass
class Ours(Worker):
    """Our monitor."""

    peer: Peer
    label: str
    kind: str  # how it is stepped, see `ours.py`

    def prepare(self, workload: Workload, rows: int) -> None:
        columns = {name: list(column[:rows]) for name, column in workload.columns.items()}
        if workload.section == "margins":
            spec, period = margin_text(workload), 1
        else:
            period = workload.period
            formulas = (scaled(formula, period) for formula in workload.formulas)
            texts = [f"always ({format_formula(formula)})" for formula in formulas]
            spec = specification(texts, columns)
        asked = {"spec": spec, "kind": self.kind, "columns": columns}
        self.peer.ask("load", rows=rows, period=period, **asked)


def margin_text(workload: Workload) -> str:
    """A specification that requires the formula from the first sample on, in sampled time."""
    required = f"upon start\n  then {format_formula(workload.formulas[0])}"
    return specification([required], workload.columns).replace("time held", "time sampled")


@dataclass
class Theirs(Worker):
    """A peer."""

    peer: Peer
    label: str  # in the tables
    way: Way  # how it is asked
    form: str = ""  # the only form of formulas that is measured; empty: both
    required: str = "{}"  # template that requires a formula at every row
    # maximum number of formulas: with more, even a few rows, or making monitors, take too long
    most: int = 1_000
    is_asked = True

    def prepare(self, workload: Workload, rows: int) -> None:
        if self.form not in ("", workload.form):
            raise UntranslatableError(f"only {self.form} forms are measured")
        formulas = [translate(formula, self.way.dialect) for formula in workload.formulas]
        if len(formulas) > self.most:
            text = f"too slow to be measured with more than {self.most} formulas"
            raise UntranslatableError(text)
        columns = {spelling(name): list(one[:rows]) for name, one in workload.columns.items()}
        required = [self.required.format(one) for one in formulas]
        self.peer.ask("load", formulas=required, kind=self.way.kind, columns=columns)

    def truths(self, question: Question) -> Sequence[bool | None]:
        return self.way.truths(self.peer, question)


def passed(command: Sequence[str | Path], later: int = 0) -> Pass:
    """One pass of a program that times its own loop; `later` is added to the rows it reports."""
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    spent, *violated = map(int, done.stdout.split())
    return Pass(spent, tuple(None if row < 0 else row + later for row in violated))


@dataclass
class NativeReelay(Contender):
    """reelay's C++ monitor over bytes in memory, one process per pass."""

    binary: Path
    label: str = "reelay C++"
    patterns: list[str] = field(default_factory=list)

    def prepare(self, workload: Workload, rows: int) -> None:
        """Write the rows to a file, which each pass reads before it starts."""
        if not set(workload.columns) <= set(LETTERS):
            raise UntranslatableError("its harness knows the columns p, q, r, s")
        columns = {name: one[:rows] for name, one in workload.columns.items()}
        (HOME / "rows.bin").write_bytes(packed(columns))
        said = (translate(formula, "REELAY_DISCRETE") for formula in workload.formulas)
        self.patterns = [f"historically({one})" for one in said]

    def run(self) -> Pass:
        return passed([self.binary, "memory", HOME / "rows.bin", *self.patterns])


_SENTIL = WAYS["sentil"]
PEERS: Sequence[tuple[Any, ...]] = (
    ("reelay", WAYS["reelay-discrete"], "past", "historically({})", 100),
    ("rtamt", RTAMT_STEPPED, "past", "historically({})", 10),
    ("mstlo", WAYS["mstlo-delayed"], "future", "{}", 100),
    ("sentil", _SENTIL, "", "always[0, inf]({})"),
)
MEASURED = (("sentil", _SENTIL), ("sentil offline", replace(_SENTIL, kind="discrete offline")))
"""The peers of the section on robustness."""

OURS = {
    "batch": {"rvmon evaluate": "evaluate"},
    "margins": {
        "rvmon, each sample": "stream",
        "rvmon, one attempt": "attempt",
        "rvmon offline": "offline",
    },
}
"""Our ways by section: label and kind, see `ours.py`."""

STEPPED = {"rvmon step": "step", "rvmon step, changes": "changes"}


def contenders(environment: Environment, section: str) -> Iterator[Contender]:
    """The contenders of a section, ours first."""
    own = ADAPTERS.with_name("ours.py")
    for label, kind in OURS.get(section, STEPPED).items():
        yield Ours(Peer(Path(sys.executable), "Rvmon", own), label, kind)
    for label, way, *more in MEASURED if section == "margins" else PEERS:
        if way.package in environment.versions:
            yield Theirs(Peer(environment.python, way.adapter), label, way, *more)
    if environment.reelay is not None and section == "batch":
        yield NativeReelay(environment.reelay)


def measure(
    workload: Workload, contenders: Sequence[Contender], repeats: int, seconds: float
) -> Result:
    """Let all contenders pass over the workload in turn; they stay open.

    A pass takes about `seconds`: slow contenders get fewer rows.
    """
    seconds *= LONGER.get(workload.section, 1)
    refusals: dict[str, str] = {}
    rows: dict[str, int] = {}
    for each in contenders:
        try:
            rows[each.label] = _prepare(each, workload, seconds)
        except (UntranslatableError, PeerError) as error:
            refusals[each.label] = str(error).splitlines()[0]
    ready = [each for each in contenders if each.label in rows]
    passes: dict[str, list[Pass]] = {each.label: [] for each in ready}
    for number, each in in_turn(ready, repeats):
        own = passes[each.label]
        if each.label in refusals or (number > 1 and own[0].cpu_ns > SLOW * seconds * 1e9):
            continue
        try:
            own.append(each.run())
        except PeerError as error:
            refusals[each.label] = str(error).splitlines()[0]
    figures = []
    for label, own in passes.items():
        if label not in refusals:
            spent = [one.cpu_ns / rows[label] for one in own]
            least, middle, most = min(spent), statistics.median(spent), max(spent)
            figures.append(Figure(label, rows[label], middle, least, most, own[-1].violated))
    about = workload.section, workload.name, workload.form, workload.rows, workload.changing
    return Result(*about, tuple(figures), tuple(refusals.items()))


def _prepare(contender: Contender, workload: Workload, seconds: float) -> int:
    """Find by growing passes how many rows fit into the time, and load them."""
    budget = seconds * 1e9
    rows = min(FEWEST_ROWS, workload.rows)
    while True:
        contender.prepare(workload, rows)
        spent = max(contender.run().cpu_ns, 1)
        fitting = min(max(int(rows * budget / spent), FEWEST_ROWS), workload.rows)
        if fitting <= rows or spent >= budget / 2:  # its fixed cost matters little
            break
        rows = min(10 * rows, fitting)
    if fitting != rows:
        contender.prepare(workload, fitting)
    return fitting


_BEGAN = time.monotonic()


def say(text: str) -> None:
    print(f"{time.monotonic() - _BEGAN:4.0f} s  {text}", file=sys.stderr, flush=True)
