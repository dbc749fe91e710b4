"""Whether two sides judge alike, before their times are set side by side.

The formulas of a workload are judged at every row of its last rows, where the Timescales families
are violated, and of traces that were damaged at random, so that both verdicts occur: ours by the
monitor that is measured, the peer by its own. Where the formula speaks of the past, the first
failure of the requirement that is timed has to be at the peer's first FALSE.

rtamt is asked for the past by the stepping that is timed, for the future by its offline evaluation.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from benchmarks.peers.client import Peer, PeerError
from benchmarks.peers.environment import Environment
from benchmarks.peers.ways import RTAMT_STEPPED, Cell, Question, Way, answers, ask_monitor
from benchmarks.timing.contenders import PEERS
from benchmarks.timing.measure import Figure
from benchmarks.timing.workload import Workload, always_text, specification
from tests.tools.common_fragment import UntranslatableError, names_in

from rvmon import loads
from rvmon.errors import RvmonError
from rvmon.testing.law.syntax import intervals
from rvmon.verdict import Verdict

WAYS_OF = {entry.label: entry.way for entry in PEERS}
"""Who is asked for the verdicts of which contender; the native reelay is the same program."""

RTAMT_BOUND = 300
"""The longest deadline of the future that its offline evaluation judges in reasonable time."""

MOST_ROWS = 4000

MOST_DAMAGED = 40
"""So many damaged traces are tried until ours is FALSE on one."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """Rows at which both sides had a verdict.

    Attributes:
        label: the contender.
        name: of the workload.
        form: of the workload.
        equal: so many were the same.
        compared: of so many.
        false: of these, ours said FALSE at so many.
        remark: why nothing was compared.
    """

    label: str
    name: str
    form: str
    equal: int = 0
    compared: int = 0
    false: int = 0
    remark: str = ""


class _Case:
    """A trace and what we say of it: at every row, and the row at which the requirement fails."""

    def __init__(self, question: Question) -> None:
        self.question = question
        self.answers = answers(question, ask_monitor)
        self.falses = self.answers.count(False)
        columns: Mapping[str, Sequence[float]] = question.columns  # type: ignore[assignment]
        monitor = loads(specification([always_text(question.formula)], columns)).monitor()
        rows = enumerate(zip(*columns.values(), strict=True))
        decided = (
            one
            for t, row in rows
            for one in monitor.step_ns(t, dict(zip(columns, row, strict=True)))
        )
        failed = (one.decided for one in decided if one.verdict is Verdict.FAIL)
        self.failure = next(failed, None)

    def shortened(self, rows: int) -> _Case:
        """So many rows of a trace: the first or the last, where ours is FALSE more often."""
        if rows >= self.question.ticks:
            return self
        ends = (_part(self.question, slice(rows)), _part(self.question, slice(-rows, None)))
        return max(map(_Case, ends), key=lambda part: part.falses)


class Referee:
    """Asks the peers for verdicts; a context manager, as it keeps their processes.

    Args:
        peers: who is asked, by label; closed at the end.
        traces: so many damaged traces are judged per workload, and more until ours is FALSE.
        seconds: that a peer may step on one workload.
        say: told what takes long.
    """

    def __init__(
        self, peers: Mapping[str, Peer], traces: int, seconds: float, say: Callable[[str], None]
    ) -> None:
        self._peers = peers
        self._traces = traces
        self._seconds = seconds
        self._say = say

    def __enter__(self) -> Referee:
        return self

    def __exit__(self, *_: object) -> None:
        for peer in self._peers.values():
            peer.close()

    def check(self, workload: Workload, timed: Sequence[Figure]) -> list[Agreement]:
        """Compare ours on the workload's first formula with each peer that can be asked.

        Args:
            workload: that was measured.
            timed: what was found: who is asked by stepping gets as many rows as fit into the time.
        """
        try:
            cases = list(_cases(workload, self._traces))
        except RvmonError as error:
            remark = str(error).splitlines()[0]
            return [Agreement("rvmon", workload.name, workload.form, remark=remark)]
        costs = {figure.label: figure.median for figure in timed}
        found: list[Agreement] = []
        form, bound = workload.form, _bound(workload)
        for label, peer in self._peers.items():
            about, way, asked, remark = (label, workload.name, form), WAYS_OF[label], cases, ""
            if label == "rtamt" and form == "future" and bound > RTAMT_BOUND:
                remark = f"future: its offline evaluation takes too long above {RTAMT_BOUND} rows"
            elif label == "rtamt" and form == "past":
                if label not in costs:
                    continue
                way, asked = RTAMT_STEPPED, self._fitting(bound, cases, costs[label])
                if not asked:
                    seconds = f"{self._seconds:g} s"
                    remark = f"past: no bound fails on the rows that it steps in {seconds}"
            if remark:
                found.append(Agreement(*about, remark=remark))
            else:
                found.append(_compared(about, way, peer, asked))
        return found

    def _fitting(self, bound: int, cases: Sequence[_Case], cost: float) -> list[_Case]:
        """As many rows as fit into the time at a cost, those first where ours is FALSE most often.

        A trace has to be longer than the formula's bound.
        """
        rows, asked = int(self._seconds * 1e9 / cost), list[_Case]()
        for case in sorted(cases, key=lambda case: case.falses, reverse=True):
            if min(rows, case.question.ticks) > bound:
                asked.append(case.shortened(rows))
                rows -= asked[-1].question.ticks
        ticks = sum(case.question.ticks for case in asked)
        if ticks * cost > 1e9:
            self._say(f"  rtamt steps {ticks:,} rows, {ticks * cost / 1e9:.0f} s")
        return asked


def peers_in(environment: Environment) -> dict[str, Peer]:
    """Who can be asked, by the label under which it is timed."""
    return {
        label: Peer(environment.python, way.adapter)
        for label, way in WAYS_OF.items()
        if way.package in environment.versions
    }


def _compared(
    about: tuple[str, str, str], way: Way, peer: Peer, cases: Sequence[_Case]
) -> Agreement:
    count: Counter[str] = Counter()
    for case in cases:
        try:
            theirs = way.truths(peer, case.question)
        except (PeerError, UntranslatableError) as error:
            return Agreement(*about, remark=str(error))
        for own, other in zip(case.answers, theirs, strict=True):
            if own is not None and other is not None:
                count.update(compared=1, equal=own is other, false=not own)
        if about[-1] == "past":
            first = theirs.index(False) if False in theirs else None
            count.update(compared=1, equal=first == case.failure)
    return Agreement(*about, count["equal"], count["compared"], count["false"])


def _cases(workload: Workload, traces: int) -> Iterator[_Case]:
    """So many damaged traces, the first further one on which ours is FALSE, and the last rows."""
    formula = workload.formulas[0]
    columns = {
        name: workload.columns[name] for name in workload.columns if name in names_in(formula)
    }
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
