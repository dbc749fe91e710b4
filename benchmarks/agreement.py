"""Whether two sides judge alike, before their times are set side by side.

The formulas of a workload are judged at every row of traces that were damaged at random, so that
both verdicts occur: ours by the engine that is measured, the peer by its own. Where the formula
speaks of the past, the first failure of the requirement that is timed has to be at the peer's first
FALSE.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.ours import always_text, specification
from benchmarks.peers.contest import CONTESTS, Contest, ask_peer
from benchmarks.peers.environment import Environment
from benchmarks.peers.positions import Question, answers, ask_engine
from benchmarks.workload import Workload

from rvmon import loads
from rvmon.errors import RvmonError
from rvmon.spec.checked import TimeModel
from rvmon.testing.peers.client import Peer, PeerError
from rvmon.testing.peers.core import UntranslatableError, names_in
from rvmon.testing.peers.ways import Cell
from rvmon.testing.walk import intervals
from rvmon.verdict.verdict import Verdict

CONTEST_OF = {"reelay": "reelay-discrete", "rtamt": "rtamt-discrete", "mstlo": "mstlo-delayed"}
"""Who is asked for the verdicts of which contender; the native reelay is the same program."""

RTAMT_BOUND = 300
MOST_ROWS = 4000


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


class Referee:
    """Asks the peers for verdicts; a context manager, as it keeps their processes.

    Args:
        environment: of the peers.
        traces: so many damaged traces are judged per workload.
    """

    def __init__(self, environment: Environment, traces: int) -> None:
        self._traces = traces
        self._peers = {
            label: Peer(environment.python, CONTESTS[name].way.worker)
            for label, name in CONTEST_OF.items()
            if CONTESTS[name].way.package in environment.versions
        }

    def __enter__(self) -> Referee:
        return self

    def __exit__(self, *_: object) -> None:
        for peer in self._peers.values():
            peer.close()

    def check(self, workload: Workload) -> list[Agreement]:
        """Compare ours on the workload's first formula with each peer that can be asked."""
        return _check(workload, self._peers, self._traces)


def _check(workload: Workload, peers: Mapping[str, Peer], traces: int) -> list[Agreement]:
    questions = [_damaged(workload, seed) for seed in range(traces)]
    try:
        ours = [answers(question, ask_engine) for question in questions]
        failures = [_first_failure(question) for question in questions]
    except RvmonError as error:
        remark = str(error).splitlines()[0]
        return [Agreement("rvmon", workload.name, workload.form, remark=remark)]
    found = []
    for label, peer in peers.items():
        if label == "rtamt" and _bound(workload) > RTAMT_BOUND:
            remark = f"not asked: its offline evaluation takes too long above {RTAMT_BOUND} rows"
            found.append(Agreement(label, workload.name, workload.form, remark=remark))
            continue
        contest = CONTESTS[CONTEST_OF[label]]
        found.append(_compare(workload, label, contest, peer, questions, ours, failures))
    return found


def _compare(
    workload: Workload,
    label: str,
    contest: Contest,
    peer: Peer,
    questions: Sequence[Question],
    ours: Sequence[Sequence[bool | None]],
    failures: Sequence[int | None],
) -> Agreement:
    count: Counter[str] = Counter()
    for question, own_answers, failure in zip(questions, ours, failures, strict=True):
        try:
            theirs = ask_peer(contest, peer, question)
        except (PeerError, UntranslatableError) as error:
            return Agreement(label, workload.name, workload.form, remark=str(error))
        for own, other in zip(own_answers, theirs, strict=True):
            if own is not None and other is not None:
                count["compared"] += 1
                count["equal"] += own is other
                count["false"] += not own
        if workload.form == "past":
            first = theirs.index(False) if False in theirs else None
            count["compared"] += 1
            count["equal"] += first == failure
    return Agreement(
        label, workload.name, workload.form, count["equal"], count["compared"], count["false"]
    )


def _first_failure(question: Question) -> int | None:
    """The row at which the requirement `always φ` fails, as it is timed."""
    columns = {
        name: [cell for cell in column if cell is not None]
        for name, column in question.columns.items()
    }
    spec = loads(specification([always_text(question.formula)], columns))
    monitor = spec.monitor()
    for row in range(question.ticks):
        for attempt in monitor.step_ns(row, {name: c[row] for name, c in columns.items()}):
            if attempt.verdict is Verdict.FAIL:
                return attempt.decided
    return None


def _bound(workload: Workload) -> int:
    found = (max(i.low, i.high or 0) for f in workload.formulas[:1] for i in intervals(f))
    return max(found, default=0)


def _damaged(workload: Workload, seed: int) -> Question:
    """Some of the rows, with single cells turned over and stretches of a column held."""
    dice = random.Random(f"{workload.name}/{seed}")
    formula = workload.formulas[0]
    names = names_in(formula)
    rows = min(max(300, 3 * _bound(workload)), MOST_ROWS, workload.rows)
    columns: Mapping[str, list[Cell]] = {
        name: list(column[:rows]) for name, column in workload.columns.items() if name in names
    }
    for column in columns.values():
        flips = dice.choice((0.0, 0.002, 0.02))
        for row in range(rows):
            if dice.random() < flips:
                value = column[row]
                column[row] = not value if isinstance(value, bool) else dice.uniform(-2.0, 2.0)
        if dice.random() < 0.5:
            start = dice.randrange(rows)
            length = min(dice.randint(1, rows // 2), rows - start)
            column[start : start + length] = [column[start]] * length
    return Question(formula, columns, frozenset(), TimeModel.HELD)
