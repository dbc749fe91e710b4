"""Check that two sides give the same verdicts, before their times are compared.

The first formula of a workload is judged at each of the last rows, where the Timescales families
are violated, and again with each column held for half of them. rvmon uses the monitor that is
timed. Each peer gets as many rows as it judges in a given time. `benchmarks.differential peers`
compares both on random formulas and traces.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from benchmarks.peers.client import PeerError
from benchmarks.peers.ways import Columns, Question, answers, ask_monitor
from benchmarks.timing.race import Contender, Figure, Theirs, margin_text
from benchmarks.timing.workload import Workload
from tests.tools.common_fragment import UntranslatableError

from rvmon import loads
from rvmon.errors import RvmonError
from rvmon.language.checked.names_read import names_read
from rvmon.testing.law.syntax import intervals

MOST_ROWS = 4000
MEASURED_ROWS = 2_000
"""The number of rows on which all figures of robustness are compared."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """The comparison of one peer on one workload, at rows where both sides had a verdict."""

    label: str  # the peer
    name: str  # workload
    form: str  # form of its formulas
    equal: int = 0  # equal verdicts
    compared: int = 0  # compared verdicts
    false: int = 0  # compared verdicts at which rvmon said FALSE
    remark: str = ""  # why nothing was compared


def by_peer(label: str) -> str:
    """The label of the peer, from the label of one of its timed ways."""
    return label.split()[0].rstrip(",")


def compare(
    workload: Workload, timed: Sequence[Figure], racing: Sequence[Contender], seconds: float
) -> Iterator[Agreement]:
    """Compare rvmon with each timed peer on the workload's first formula.

    Each peer gets as many rows as it judges in `seconds`.
    """
    formula = workload.formulas[0]
    bound = max((max(i.low, i.high or 0) for i in intervals(formula)), default=0)
    costs = {figure.label: figure.median for figure in timed}
    for one in [one for one in racing if one.is_asked and one.label in costs]:
        about = Agreement(by_peer(one.label), workload.name, workload.form)
        fitting = int(seconds * 1e9 / costs[one.label])
        rows = min(max(300, 3 * bound), MOST_ROWS, workload.rows, fitting)
        if rows <= bound:
            text = f"no bound fails on the rows that it judges in {seconds:g} s"
            yield replace(about, remark=f"{workload.form}: {text}")
            continue
        columns = {name: workload.columns[name][-rows:] for name in sorted({*names_read(formula)})}
        both: list[tuple[bool | None, bool | None]] = []
        try:
            for own in _with_stretches(columns):
                question = Question(formula, own)
                theirs = one.truths(question)
                both += zip(answers(question, ask_monitor), theirs, strict=True)
        except (PeerError, UntranslatableError, RvmonError) as error:
            yield replace(about, remark=str(error).splitlines()[0])
            continue
        both = [pair for pair in both if None not in pair]
        equal, false = sum(ours is its for ours, its in both), sum(not ours for ours, _ in both)
        yield replace(about, equal=equal, compared=len(both), false=false)


def _with_stretches(columns: Columns) -> Iterator[Columns]:
    """The columns, then variants with one column held in the second half, to get both verdicts."""
    yield columns
    for name, column in columns.items():
        half = len(column) // 2
        yield {**columns, name: [*column[:half], *[column[half]] * (len(column) - half)]}


def margins_alike(workload: Workload, sentil: Theirs) -> Agreement:
    """Compare SENTIL's figures with ours: by arrays, per sample, and for one attempt.

    Rows near the end are left out: SENTIL truncates windows there, and our figure is an interval.
    """
    columns = {name: list(column[:MEASURED_ROWS]) for name, column in workload.columns.items()}
    theirs = sentil.way.says(sentil.peer, Question(workload.formulas[0], columns))
    spec = loads(margin_text(workload))
    arrays = {name: np.array(column) for name, column in columns.items()}
    offline = spec.robustness({"t_ns": np.arange(MEASURED_ROWS), **arrays}, time="t_ns")
    sure = {t for t, one in offline.streams["R1"] if one.low == one.high}
    ours = [(t, one.low) for t, one in offline.streams["R1"]]
    for streams in (True, False):
        monitor = spec.robustness_monitor(streams=streams)
        for t, row in enumerate(zip(*columns.values(), strict=True)):
            found = monitor.step_ns(t, dict(zip(columns, row, strict=True)))
            ours += [(one.t, one.robustness.low) for one in found]
    pairs = [(low, theirs[t]) for t, low in ours if t in sure]
    equal, false = sum(own == its for own, its in pairs), sum(own < 0 for own, _ in pairs)
    return Agreement("sentil", workload.name, workload.form, equal, len(pairs), false)
