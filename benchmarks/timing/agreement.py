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
from benchmarks.peers.contest import CONTESTS, RTAMT_STEPPED, Contest, ask_peer
from benchmarks.peers.environment import Environment
from benchmarks.peers.positions import Question, answers, ask_monitor
from benchmarks.peers.ways import Cell
from benchmarks.timing.measure import Figure
from benchmarks.timing.workload import Workload, always_text, specification
from tests.tools.common_fragment import UntranslatableError, names_in

from rvmon import loads
from rvmon.errors import RvmonError
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.law.syntax import intervals
from rvmon.verdict import Verdict
from rvmon.verdict.attempt import Attempt

CONTEST_OF = {
    "reelay": "reelay-discrete",
    "rtamt": "rtamt-discrete",
    "mstlo": "mstlo-delayed",
    "sentil": "sentil",
}
"""Who is asked for the verdicts of which contender; the native reelay is the same program."""

STEPPED = {"rtamt": RTAMT_STEPPED}
"""Who is asked for the past row by row, as timed; a later row costs as much as an early one."""

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


@dataclass(frozen=True, slots=True)
class _Case:
    """A trace and what we say of it: at every row, and the row at which the requirement fails."""

    question: Question
    answers: Sequence[bool | None]
    failure: int | None

    @property
    def falses(self) -> int:
        """The rows at which ours is FALSE."""
        return sum(answer is False for answer in self.answers)


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
        found: list[Agreement] = []
        for label, peer in self._peers.items():
            if workload.form == "past" and label in STEPPED:
                costs = [figure.median for figure in timed if figure.label == label]
                found += [self._step(workload, label, peer, cases, cost) for cost in costs]
            elif label == "rtamt" and _bound(workload) > RTAMT_BOUND:
                remark = f"future: its offline evaluation takes too long above {RTAMT_BOUND} rows"
                found.append(Agreement(label, workload.name, workload.form, remark=remark))
            else:
                contest = CONTESTS[CONTEST_OF[label]]
                found.append(_compare(workload, label, contest, peer, cases))
        return found

    def _step(
        self, workload: Workload, label: str, peer: Peer, cases: Sequence[_Case], cost: float
    ) -> Agreement:
        """Compare on as many rows as fit into the time, beginning where ours is FALSE most often.

        Args:
            workload: of the past.
            label: the peer's.
            peer: its process.
            cases: of which a part is taken where there is no time for all.
            cost: CPU ns of a row.
        """
        rows = int(self._seconds * 1e9 / cost)
        asked: list[_Case] = []
        for case in sorted(cases, key=lambda case: case.falses, reverse=True):
            if min(rows, case.question.ticks) > _bound(workload):
                asked.append(_shortened(case, rows))
                rows -= asked[-1].question.ticks
        if not asked:
            remark = f"past: no bound fails on the rows that it steps in {self._seconds:g} s"
            return Agreement(label, workload.name, workload.form, remark=remark)
        ticks = sum(case.question.ticks for case in asked)
        if ticks * cost > 1e9:
            self._say(f"  {label} steps {ticks:,} rows, {ticks * cost / 1e9:.0f} s")
        return _compare(workload, label, STEPPED[label], peer, asked)


def peers_in(environment: Environment) -> dict[str, Peer]:
    """Who can be asked, by the label under which it is timed."""
    return {
        label: Peer(environment.python, CONTESTS[name].way.worker)
        for label, name in CONTEST_OF.items()
        if CONTESTS[name].way.package in environment.versions
    }


def _compare(
    workload: Workload, label: str, contest: Contest, peer: Peer, cases: Sequence[_Case]
) -> Agreement:
    count: Counter[str] = Counter()
    for case in cases:
        try:
            theirs = ask_peer(contest, peer, case.question)
        except (PeerError, UntranslatableError) as error:
            return Agreement(label, workload.name, workload.form, remark=str(error))
        for own, other in zip(case.answers, theirs, strict=True):
            if own is not None and other is not None:
                count["compared"] += 1
                count["equal"] += own is other
                count["false"] += not own
        if workload.form == "past":
            first = theirs.index(False) if False in theirs else None
            count["compared"] += 1
            count["equal"] += first == case.failure
    return Agreement(
        label, workload.name, workload.form, count["equal"], count["compared"], count["false"]
    )


def _cases(workload: Workload, traces: int) -> Iterator[_Case]:
    """So many damaged traces, the first further one on which ours is FALSE, and the last rows."""
    seen = False
    for seed in range(MOST_DAMAGED):
        if seed >= traces and seen:
            break
        case = _case(_damaged(workload, seed))
        seen = seen or case.falses > 0
        if seed < traces or seen:
            yield case
    yield _case(_part(_question(workload), slice(-_rows_judged(workload), None)))


def _case(question: Question) -> _Case:
    return _Case(question, answers(question, ask_monitor), _first_failure(question))


def _first_failure(question: Question) -> int | None:
    """The row at which the requirement `always φ` fails, as it is timed."""
    decided = (attempt for row in _stepped(question) for attempt in row)
    return next((one.decided for one in decided if one.verdict is Verdict.FAIL), None)


def _stepped(question: Question) -> Iterator[Sequence[Attempt]]:
    """What each row decides of the requirement `always φ`."""
    columns = {
        name: [cell for cell in column if cell is not None]
        for name, column in question.columns.items()
    }
    spec = loads(specification([always_text(question.formula)], columns))
    monitor = spec.monitor()
    for row in range(question.ticks):
        yield monitor.step_ns(row, {name: column[row] for name, column in columns.items()})


def _bound(workload: Workload) -> int:
    found = (max(i.low, i.high or 0) for f in workload.formulas[:1] for i in intervals(f))
    return max(found, default=0)


def _rows_judged(workload: Workload) -> int:
    return min(max(300, 3 * _bound(workload)), MOST_ROWS, workload.rows)


def _question(workload: Workload) -> Question:
    """The first formula on the whole trace."""
    formula = workload.formulas[0]
    names = names_in(formula)
    columns = {name: column for name, column in workload.columns.items() if name in names}
    return Question(formula, columns, frozenset(), TimeModel.HELD)


def _part(question: Question, rows: slice) -> Question:
    """Some of the rows of a trace, which are a trace themselves."""
    columns = {name: column[rows] for name, column in question.columns.items()}
    return replace(question, columns=columns)


def _shortened(case: _Case, rows: int) -> _Case:
    """So many rows of a trace: the first or the last, where ours is FALSE more often."""
    if rows >= case.question.ticks:
        return case
    ends = [_part(case.question, slice(rows)), _part(case.question, slice(-rows, None))]
    return max(map(_case, ends), key=lambda part: part.falses)


def _damaged(workload: Workload, seed: int) -> Question:
    """The first rows, with single cells turned over and stretches of a column held."""
    rng = random.Random(f"{workload.name}/{seed}")
    rows = _rows_judged(workload)
    whole = _question(workload)
    columns: dict[str, list[Cell]] = {
        name: list(column[:rows]) for name, column in whole.columns.items()
    }
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
    return replace(whole, columns=columns)
