"""Measuring: passes of all contenders in turn, so that what the machine does meets all alike."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.peers.client import PeerError
from benchmarks.timing.contenders import Contender, Pass
from benchmarks.timing.workload import Workload
from tests.tools.common_fragment import UntranslatableError

FEWEST_ROWS = 50
"""Of a pass, however slow the contender; as many tell how slow it is."""

SLOW = 10
"""Who needs so many times the time of a pass, with what it makes for it, passes twice only."""


LONGER = {"batch": 10, "many": 5}
"""So many times as long is a pass, of what is judged as a whole or takes long to begin."""


@dataclass(frozen=True, slots=True)
class Size:
    """How much is measured.

    Attributes:
        rows: of the traces that are judged row by row.
        columns: rows of what is judged in memory or by whole processes; and a tenth of them.
        longest: rows of the traces on which deadlines grow.
        bounds: of the Timescales families.
        seconds: of the robot's stream.
        counts: of monitors on one stream.
        traces: damaged ones per agreement.
        step_seconds: that a peer may step on one workload to be compared.
        repeats: passes of each contender.
        processes: of each program, beside a first one that does not count.
        file_rows: of one large file.
        files: of many.
        pass_seconds: what one pass may take.
    """

    rows: int = 50_000
    columns: int = 1_000_000
    longest: int = 300_000
    bounds: tuple[int, ...] = (10, 100, 1000)
    seconds: int = 300
    counts: tuple[int, ...] = (10, 100, 1000)
    traces: int = 2
    step_seconds: float = 30
    repeats: int = 5
    processes: int = 3
    file_rows: int = 10_000_000
    files: int = 1_000
    pass_seconds: float = 0.1

    def seconds_of(self, section: str) -> float:
        """What one pass may take; slow contenders get fewer rows."""
        return self.pass_seconds * LONGER.get(section, 1)


QUICK = Size(
    rows=5_000,
    columns=100_000,
    longest=20_000,
    bounds=(10, 1000),
    seconds=60,
    counts=(10, 100),
    traces=1,
    step_seconds=10,
    repeats=3,
    processes=2,
    file_rows=1_000_000,
    files=40,
    pass_seconds=0.05,
)


@dataclass(frozen=True, slots=True)
class Figure:
    """What one contender needed for one workload.

    Attributes:
        label: the contender.
        rows: of each pass.
        median: CPU ns per row.
        least: of the passes.
        most: of the passes.
        violated: the first violated row of each formula.
    """

    label: str
    rows: int
    median: float
    least: float
    most: float
    violated: tuple[int | None, ...]


@dataclass(frozen=True, slots=True)
class Result:
    """All figures of one workload.

    Attributes:
        section: the table.
        name: the line.
        form: `past` or `future`.
        rows: of the whole trace.
        changing: the share of rows at which something changes.
        figures: of the contenders that took part.
        refusals: of the others, the reason by label.
    """

    section: str
    name: str
    form: str
    rows: int
    changing: float
    figures: tuple[Figure, ...]
    refusals: tuple[tuple[str, str], ...] = ()


def measure(
    workload: Workload, contenders: Sequence[Contender], repeats: int, seconds: float
) -> Result:
    """Give the workload to all contenders and let them pass over it in turn; they stay open.

    Args:
        workload: given to all.
        contenders: who passes.
        repeats: passes of each.
        seconds: what one may take.
    """
    ready: list[tuple[Contender, int]] = []
    refusals: list[tuple[str, str]] = []
    for contender in contenders:
        try:
            ready.append((contender, _prepare(contender, workload, seconds)))
        except (UntranslatableError, PeerError) as error:
            refusals.append((contender.label, str(error).splitlines()[0]))
    passes: dict[str, list[Pass]] = {contender.label: [] for contender, _ in ready}
    slow: list[tuple[Contender, int]] = []
    for number in range(repeats):
        turn = number % max(len(ready), 1)
        for contender, rows in [*ready[turn:], *ready[:turn]]:
            began = time.monotonic()
            try:
                done = contender.run()
            except PeerError as error:
                refusals.append((contender.label, str(error).splitlines()[0]))
                ready.remove((contender, rows))
                continue
            passes[contender.label].append(done)
            whole = max(time.monotonic() - began, done.cpu_ns / 1e9)
            if whole > SLOW * seconds and number == 1:
                ready.remove((contender, rows))
                slow.append((contender, rows))
    figures = tuple(
        figure_of(
            contender.label,
            rows,
            [one.cpu_ns for one in passes[contender.label]],
            passes[contender.label][-1].violated,
        )
        for contender, rows in [*ready, *slow]
    )
    return result_of(workload, figures, refusals)


def figure_of(
    label: str, rows: int, cpu_ns: Sequence[float], violated: tuple[int | None, ...]
) -> Figure:
    """Of the CPU nanoseconds of some passes."""
    least, middle, most = min(cpu_ns), statistics.median(cpu_ns), max(cpu_ns)
    return Figure(label, rows, middle / rows, least / rows, most / rows, violated)


def result_of(
    workload: Workload, figures: Sequence[Figure], refusals: Sequence[tuple[str, str]]
) -> Result:
    """The figures with what tells the workload, but not its rows."""
    one = workload
    about = one.section, one.name, one.form, one.rows, one.changing
    return Result(*about, tuple(figures), tuple(refusals))


def _prepare(contender: Contender, workload: Workload, seconds: float) -> int:
    """Find by passes that grow how many rows fit into the time, and load them."""
    budget = seconds * 1e9
    rows = min(FEWEST_ROWS, workload.rows)
    while True:
        contender.prepare(workload, rows)
        spent = max(contender.run().cpu_ns, 1)
        fitting = min(max(int(rows * budget / spent), FEWEST_ROWS), workload.rows)
        if fitting <= rows or spent >= budget / 2:  # what each pass costs once weighs little
            break
        rows = min(10 * rows, fitting)
    if fitting != rows:
        contender.prepare(workload, fitting)
    return fitting
