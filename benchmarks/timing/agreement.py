"""Whether two sides judge alike, before their times are set side by side.

The formulas of a workload are judged at every row of its last rows, where the Timescales families
are violated, and of traces that were damaged at random, so that both verdicts occur: ours by the
monitor that is measured, the peer by its own, on as many rows as it judges in a given time. rtamt,
which is timed on the past, is stepped for that.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from benchmarks.peers.client import Peer, PeerError
from benchmarks.peers.environment import Environment
from benchmarks.peers.ways import RTAMT_STEPPED, WAYS, Cell, Question, Way, answers, ask_monitor
from benchmarks.timing.race import PEERS, Figure, margin_text
from benchmarks.timing.workload import Size, Workload
from tests.tools.common_fragment import UntranslatableError

from rvmon import loads
from rvmon.errors import RvmonError
from rvmon.language.checked.names_read import names_read
from rvmon.testing.law.syntax import intervals

WAYS_OF = {entry.label: entry.way for entry in PEERS} | {"rtamt": RTAMT_STEPPED}
"""Who is asked for the verdicts of which contender; the native reelay is the same program."""

MOST_ROWS = 4000
MOST_DAMAGED = 40
"""So many damaged traces are tried until ours is FALSE on one."""

MEASURED_ROWS = 2_000
"""Of which all figures of robustness are compared."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """Rows at which both sides had a verdict."""

    label: str  # the contender
    name: str  # of the workload
    form: str  # of the workload
    equal: int = 0  # so many were the same
    compared: int = 0  # of so many
    false: int = 0  # of these, ours said FALSE at so many
    remark: str = ""  # why nothing was compared


def by_peer(label: str) -> str:
    """The label of the peer, of one of the ways in which it is timed."""
    return label.split()[0].rstrip(",")


class _Case:
    """A trace, and what we say of it at every row."""

    def __init__(self, question: Question) -> None:
        self.question = question
        self.answers = answers(question, ask_monitor)
        self.falses = self.answers.count(False)


def peers_in(environment: Environment) -> dict[str, Peer]:
    """Who can be asked, by the label under which it is timed."""
    return {
        label: Peer(environment.python, way.adapter)
        for label, way in WAYS_OF.items()
        if way.package in environment.versions
    }


def compare(
    workload: Workload, timed: Sequence[Figure], peers: Mapping[str, Peer], size: Size
) -> Iterator[Agreement]:
    """Compare ours on the workload's first formula with each peer that was timed.

    Args:
        workload: the measured workload.
        timed: the figures: a peer gets as many rows as it judges in the time.
        peers: the other monitors, by label.
        size: the number of traces, and the time for which a peer may judge.
    """
    name, form = workload.name, workload.form
    try:
        cases = list(_cases(workload, size.traces))
    except RvmonError as error:
        yield Agreement("rvmon", name, form, remark=str(error).splitlines()[0])
        return
    costs = {by_peer(figure.label): figure.median for figure in timed}
    for label in [one for one in peers if one in costs]:
        fitting = int(size.step_seconds * 1e9 / costs[label])
        asked = [*_fitting(cases, _bound(workload), fitting)]
        if asked:
            yield _compared(Agreement(label, name, form), WAYS_OF[label], peers[label], asked)
        else:
            text = f"{form}: no bound fails on the rows that it judges in {size.step_seconds:g} s"
            yield Agreement(label, name, form, remark=text)


def _fitting(cases: Sequence[_Case], bound: int, rows: int) -> Iterator[_Case]:
    """Cases of so many rows in all, those first where ours is FALSE most often; the ends of them.

    A trace has to be longer than the formula's bound.
    """
    for case in sorted(cases, key=lambda case: case.falses, reverse=True):
        taken = min(rows, case.question.ticks)
        if taken > bound:
            rows -= taken
            ends = (slice(taken), slice(-taken, None)) if taken < case.question.ticks else ()
            parts = [_Case(_part(case.question, one)) for one in ends] or [case]
            yield max(parts, key=lambda part: part.falses)


def _compared(about: Agreement, way: Way, peer: Peer, cases: Sequence[_Case]) -> Agreement:
    count: Counter[str] = Counter()
    for case in cases:
        try:
            theirs = way.truths(peer, case.question)
        except (PeerError, UntranslatableError) as error:
            return replace(about, remark=str(error))
        for own, other in zip(case.answers, theirs, strict=True):
            if own is not None and other is not None:
                count.update(compared=1, equal=own is other, false=not own)
    return replace(about, equal=count["equal"], compared=count["compared"], false=count["false"])


def _cases(workload: Workload, traces: int) -> Iterator[_Case]:
    """So many damaged traces, the first further one on which ours is FALSE, and the last rows."""
    formula = workload.formulas[0]
    read = {*names_read(formula)}
    columns = {name: one for name, one in workload.columns.items() if name in read}
    whole = Question(formula, columns)
    rows = min(max(300, 3 * _bound(workload)), MOST_ROWS, workload.rows)
    seen = False
    for seed in range(MOST_DAMAGED):
        if seed >= traces and seen:
            break
        case = _Case(_damaged(_part(whole, slice(rows)), f"{workload.name}/{seed}"))
        seen = seen or case.falses > 0
        if seed < traces or seen:
            yield case
    yield _Case(_part(whole, slice(-rows, None)))


def _bound(workload: Workload) -> int:
    found = (max(i.low, i.high or 0) for f in workload.formulas[:1] for i in intervals(f))
    return max(found, default=0)


def _part(question: Question, rows: slice) -> Question:
    """Some of the rows of a trace, which are a trace themselves."""
    columns = {name: column[rows] for name, column in question.columns.items()}
    return replace(question, columns=columns)


def _damaged(question: Question, seed: str) -> Question:
    """The rows with single cells turned over and stretches of a column held."""
    rng, rows = random.Random(seed), question.ticks
    columns: dict[str, list[Cell]] = {n: list(column) for n, column in question.columns.items()}
    for column in columns.values():
        flips = rng.choice((0.0, 0.002, 0.02))
        for row in range(rows):
            if rng.random() < flips:
                value = column[row]
                column[row] = not value if isinstance(value, bool) else rng.uniform(-2.0, 2.0)
        if rng.random() < 0.5:
            start = rng.randrange(rows)
            length = min(rng.randint(1, rows // 2), rows - start)
            column[start : start + length] = [column[start]] * length
    return replace(question, columns=columns)


def margins_alike(workload: Workload, environment: Environment) -> Iterator[Agreement]:
    """Whether SENTIL's figures are ours: by arrays, a sample at a time, and as it is required.

    It counts a window that the trace cuts short as it is; ours is then no single number.
    """
    way = WAYS["sentil"]
    if way.package not in environment.versions:
        return
    columns = {name: list(column[:MEASURED_ROWS]) for name, column in workload.columns.items()}
    with Peer(environment.python, way.adapter) as peer:
        theirs = way.says(peer, Question(workload.formulas[0], columns))
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
    yield Agreement("sentil", workload.name, workload.form, equal, len(pairs), false)
