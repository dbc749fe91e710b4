"""Numbers of attempts, and their figures until somebody takes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from weakref import WeakKeyDictionary

from rvmon.automaton.location import Token
from rvmon.dataflow.margins import INFINITE
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open
from rvmon.monitor.records.ledger import Ledger, verdict_at_end
from rvmon.monitor.robustness.margin_judge import MarginJudge
from rvmon.monitor.robustness.values import Measured, Robustness
from rvmon.trace.time import TIME_LIMIT
from rvmon.verdict.verdict import Verdict


class Gauged(Ledger):
    """Numbers attempts as the ledger of records does, and keeps their figures until taken.

    Attributes:
        heard: the instant of the sample that came last.
        beside: by the judge of attempts, the one that measures them.
        vanished: attempts in doubt that were met and leave no record, up to their figures.
    """

    def __init__(self) -> None:
        super().__init__()
        self.heard = -TIME_LIMIT
        self.beside: WeakKeyDictionary[AttemptJudge, MarginJudge] = WeakKeyDictionary()
        self.vanished: set[Open] = set()
        self._found: list[tuple[MarginJudge, Open | None, int, Robustness]] = []
        self._ends: dict[AttemptJudge, Mapping[int, Robustness]] = {}

    def sure(self, judge: AttemptJudge, attempt: Open, t: int) -> None:
        """See `Ledger`; what was in doubt before is measured already."""
        super().sure(judge, attempt, t)
        if t == attempt.triggered:
            self._measure(judge, attempt)

    def doubtful(self, judge: AttemptJudge, attempt: Open, t: int) -> None:
        """See `Ledger`."""
        super().doubtful(judge, attempt, t)
        self._measure(judge, attempt)

    def _measure(self, judge: AttemptJudge, attempt: Open) -> None:
        self.measure(self.beside[judge], attempt)

    def measure(self, judge: MarginJudge, attempt: Open) -> None:
        """Have an attempt that begins now measured."""
        sampled = judge.flow.gap is None
        judge.measure(attempt, judge.flow.position if sampled else attempt.triggered)

    def decided(self, _: AttemptJudge, attempt: Open, verdict: bool, __: int, ___: Token) -> None:
        """See `rvmon.monitor.attempts.attempt_judge.Clerk`; there are no records."""
        if not attempt.sure and verdict and not attempt.void:
            self.vanished.add(attempt)

    def settled(self, judge: MarginJudge, attempt: Open, found: Robustness) -> None:
        """See `rvmon.monitor.robustness.margin_judge.Gauger`."""
        self._found.append((judge, attempt, attempt.triggered, found))

    def passed(self, judge: MarginJudge, t: int, found: Robustness) -> None:
        """See `rvmon.monitor.robustness.margin_judge.Gauger`."""
        self._found.append((judge, None, t, found))

    def ended(self, judge: AttemptJudge, attempt: Open, end: int, reached: int) -> None:
        """See `Ledger`; each attempt is seen by its own judge first."""
        if isinstance(judge, MarginJudge):
            if judge not in self._ends:
                self._ends[judge] = judge.figures(end, reached)
            self.settled(judge, attempt, self._ends[judge][judge.positions[attempt]])
        elif not attempt.sure:
            verdict, _ = verdict_at_end(judge, attempt, end, reached)
            if verdict is Verdict.PASS:
                self.vanished.add(attempt)

    @property
    def waiting(self) -> Sequence[Measured]:
        """The figures of attempts of which it is not known what becomes of them."""
        return [measured(judge, attempt, found, t) for judge, attempt, t, found in self._found]

    def taken(self, *, over: bool) -> Sequence[Measured]:
        """What was found since the last time; all attempts are numbered.

        Args:
            over: whether the run is; before, those in doubt may still vanish or become sure.
        """
        if not self._found:
            return ()
        found, self._found = self._found, []
        settled = []
        for one in sorted(found, key=lambda one: (one[2], one[0].compiled.rank, one[1] is None)):
            attempt = one[1]
            if attempt in self.vanished:
                self.vanished.discard(attempt)
            elif attempt is None or attempt.sure or over:
                settled.append(measured(one[0], attempt, one[3], one[2]))
            else:
                self._found.append(one)
        return settled


def measured(judge: MarginJudge, attempt: Open | None, found: Robustness, t: int) -> Measured:
    """A figure as it is given out.

    Args:
        judge: has found it.
        attempt: that it is of; `None`: of what is owed at a position.
        found: the figure.
        t: the instant of the trigger, or of the position.
    """
    name = judge.compiled.requirement.id
    if attempt is None:
        return Measured(name, None, t, found)
    if attempt.sure:
        return Measured(name, attempt.number, t, found)
    # Where nothing triggered it, nothing is owed.
    possible = Robustness(found.low, INFINITE, found.kept)
    return Measured(name, attempt.doubtful_number, t, possible, in_doubt=True)
