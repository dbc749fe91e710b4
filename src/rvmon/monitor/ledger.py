"""The records of attempts, numbered in order of trigger."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import Token
from rvmon.formula.progress import after, holds_at_end
from rvmon.monitor.judge import Judge, Open
from rvmon.verdict.attempt import Attempt, Decision
from rvmon.verdict.end import settle_at_end
from rvmon.verdict.verdict import Verdict


class Ledger:
    """Takes starts and decisions as they come and gives the records in their order.

    Attributes:
        attempts: all records given out.
    """

    def __init__(self) -> None:
        self.attempts: list[Attempt] = []
        self._counts: dict[str, int] = {}
        self._started: list[tuple[int, int, Judge, Open]] = []
        self._decided: list[tuple[Judge, Open, Attempt]] = []

    def started(self, instance: int, judge: Judge, attempt: Open) -> None:
        """Take a new attempt, to be numbered by its trigger and the rank of its instance."""
        self._started.append((attempt.triggered, instance, judge, attempt))

    def decided(self, judge: Judge, attempt: Open, verdict: bool, t: int, before: Token) -> None:
        """See `rvmon.monitor.judge.Clerk`."""
        upon_end = judge.compiled.obligation.trigger is None
        record = Attempt(
            judge.compiled.requirement.id,
            0,
            attempt.triggered,
            attempt.triggered if upon_end else t,
            Verdict.PASS if verdict else Verdict.FAIL,
            captured=judge.captured,
        )
        self._decided.append((judge, attempt, record))

    def ended(self, judge: Judge, attempt: Open, end: int, reached: int) -> None:
        """Take an attempt that is undecided at the end of the trace."""
        requirement = judge.compiled.requirement
        location, anchors = attempt.token
        residual = after(judge.machine.residual(location), [reached - a for a in anchors])
        verdict, decision = settle_at_end(
            requirement.at_end,
            held=holds_at_end(residual, [end - a for a in anchors]),
            cannot_pass=location == FAILED,
            cannot_fail=attempt.better is not None and attempt.better[0] == PASSED,
        )
        record = Attempt(
            requirement.id,
            0,
            attempt.triggered,
            None if decision is Decision.OPEN else end,
            verdict,
            decision,
            captured=judge.captured,
        )
        self._decided.append((judge, attempt, record))

    def open_record(self, judge: Judge, attempt: Open) -> Attempt:
        """The record of an attempt that is still running."""
        return Attempt(
            judge.compiled.requirement.id,
            attempt.number,
            attempt.triggered,
            None,
            Verdict.INCONCLUSIVE,
            Decision.OPEN,
            captured=judge.captured,
        )

    def flush(self) -> Sequence[Attempt]:
        """Number what started, and give the records of what was decided, in the law's order."""
        if self._started:
            self._started.sort(key=lambda entry: entry[:2])
            for _, _, judge, attempt in self._started:
                name = judge.compiled.requirement.id
                attempt.number = self._counts[name] = self._counts.get(name, 0) + 1
            self._started.clear()
        if not self._decided:
            return ()
        made = [
            (judge.compiled.rank, replace(record, number=attempt.number))
            for judge, attempt, record in self._decided
        ]
        self._decided.clear()
        made.sort(key=lambda entry: _order(*entry))
        records = [record for _, record in made]
        self.attempts += records
        return records


def _order(rank: int, record: Attempt) -> tuple[bool, int, int, int]:
    return (record.decided is None, record.decided or 0, rank, record.number)
