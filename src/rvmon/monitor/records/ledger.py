"""The records of attempts, numbered in order of trigger."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rvmon.automaton.location import FAILED, PASSED, Token
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open
from rvmon.monitor.attempts.network_judge import NetworkJudge
from rvmon.monitor.explained.explanation import Explanation, truths_shown
from rvmon.monitor.explained.undecided import forecast_of, why_nothing, why_open, why_settled
from rvmon.monitor.records.explain import undecided, why_decided
from rvmon.monitor.records.explain_network import network_details, note_decision
from rvmon.trace.sample import Scalar
from rvmon.verdict.attempt import Attempt, Decision, decided_attempt
from rvmon.verdict.end import settle_at_end
from rvmon.verdict.verdict import Verdict


class Ledger:
    """Takes starts and decisions as they come and gives the records in their order.

    Attributes:
        attempts: all records given out.
        void: attempts that have met what they owe, but say nothing: the place of the requirement,
            the attempt, its record without a number.
        recorded: decisions whose records are made: the instant, the place of the requirement in the
            file, the number of the attempt, the record.
    """

    STATE = ("attempts", "_counts", "_doubts", "void")

    def __init__(self) -> None:
        self.attempts: list[Attempt] = []
        self._counts: dict[str, int] = {}
        self._started: list[tuple[int, AttemptJudge, Open]] = []
        self._doubtful: list[tuple[int, AttemptJudge, Open]] = []
        self._doubts: dict[str, int] = {}
        self.void: list[tuple[int, Open, Attempt]] = []
        self._decided: list[tuple[AttemptJudge, Open, Attempt]] = []
        self.recorded: list[tuple[int, int, int, Attempt]] = []

    def sure(self, judge: AttemptJudge, attempt: Open, t: int) -> None:
        """Take an attempt whose trigger was true, at `t` first, to be numbered by that.

        Its trigger decides between equal instants, then the rank of its instance.
        """
        self._started.append((t, judge, attempt))

    def doubtful(self, judge: AttemptJudge, attempt: Open, t: int) -> None:
        """Take a new attempt of which it is not known whether there was a trigger; see `sure`."""
        self._doubtful.append((t, judge, attempt))

    def next_doubtful(self, name: str) -> int:
        """The number of another attempt in doubt of a requirement."""
        self._doubts[name] = self._doubts.get(name, 0) + 1
        return self._doubts[name]

    def opened(self, judge: AttemptJudge, triggered: int, token: Token, sure: bool) -> Open:
        """See `rvmon.monitor.attempts.attempt_judge.Clerk`."""
        attempt = Open(triggered, token, judge.seen)
        attempt.void = judge.flow.is_cut
        attempt.sure = sure
        if judge.hidden:
            attempt.doubt = judge.doubt
        (self.sure if sure else self.doubtful)(judge, attempt, triggered)
        return attempt

    def assured(self, judge: AttemptJudge, attempt: Open) -> None:
        """See `rvmon.monitor.attempts.attempt_judge.Clerk`."""
        self.sure(judge, attempt, judge.flow.position)

    def parted(self, judge: AttemptJudge, attempt: Open, apart: bool) -> None:
        """See `rvmon.monitor.attempts.attempt_judge.Clerk`."""
        if not judge.hidden:
            attempt.doubt = judge.doubt if apart else None

    def decided(
        self, judge: AttemptJudge, attempt: Open, verdict: bool, t: int, before: Token
    ) -> None:
        """See `rvmon.monitor.attempts.attempt_judge.Clerk`."""
        if verdict and attempt.void:
            self.say_nothing(judge, attempt)
            return
        if not attempt.sure:
            if not verdict:
                self.say_nothing(judge, attempt)
            return  # if met, triggered or not
        upon_end = judge.compiled.obligation.trigger is None
        decided = attempt.triggered if upon_end else t
        truth = Verdict.PASS if verdict else Verdict.FAIL
        if isinstance(judge, NetworkJudge):
            name, noted = judge.compiled.requirement.id, note_decision(judge, attempt, verdict, t)
            record = decided_attempt(
                name, 0, attempt.triggered, decided, truth, network_details, noted
            )
        else:
            why = why_decided(judge, attempt, verdict, t, before)
            record = _record(judge, attempt, decided, truth, Decision.PREFIX, why)
        self._decided.append((judge, attempt, record))

    def ended(self, judge: AttemptJudge, attempt: Open, end: int, reached: int) -> None:
        """Take an attempt that is undecided at the end of the trace."""
        requirement = judge.compiled.requirement
        verdict, decision = verdict_at_end(judge, attempt, end, reached)
        if verdict is Verdict.PASS and not attempt.sure:
            return
        now = max(2 * reached, 2 * end + 1)
        judged, its = undecided(judge, attempt, now)
        why = why_open(judged, its, now, end)
        if decision is not Decision.OPEN:
            why = replace(why, reason=why_settled(decision, requirement.at_end))
        decided = None if decision is Decision.OPEN else end
        record = _record(judge, attempt, decided, verdict, decision, why)
        if decided is None:
            record = replace(record, forecast=forecast_of(judged, its, now))
        self._decided.append((judge, attempt, record))

    def say_nothing(self, judge: AttemptJudge, attempt: Open) -> None:
        """Take an attempt that stays undecided, whatever comes."""
        why = why_nothing(cut=judge.flow.is_cut)
        record = _record(judge, attempt, None, Verdict.INCONCLUSIVE, Decision.OPEN, why)
        self.void.append((judge.compiled.rank, attempt, record))

    @property
    def void_records(self) -> Sequence[Attempt]:
        """The records of these attempts, in the law's order; all of them are numbered."""
        found = [(rank, replace(one, number=_number(own))) for rank, own, one in self.void]
        return [record for _, record in sorted(found, key=lambda entry: _order(*entry))]

    def close(self) -> Sequence[Attempt]:
        """Give the last records, when all attempts are decided or ended."""
        found = [*self.flush(), *self.void_records]
        self.attempts += self.void_records
        self.void.clear()
        return found

    def open_record(self, judge: AttemptJudge, attempt: Open, now: int) -> Attempt:
        """The record of an attempt that is still running; `now` as in `undecided`."""
        judged, its = undecided(judge, attempt, now)
        why = why_open(judged, its, now)
        record = _record(judge, attempt, None, Verdict.INCONCLUSIVE, Decision.OPEN, why)
        return replace(record, forecast=forecast_of(judged, its, now))

    def flush(self) -> Sequence[Attempt]:
        """Number what started, and give the records of what was decided, in the law's order."""
        if self._started or self._doubtful:
            self._number_new()
        if not self._decided:
            if not self.recorded:
                return ()
            if len(self.recorded) == 1:
                ((_, _, _, record),) = self.recorded
                records = [record]
            else:
                # No two are of one instant, requirement and number: no records are compared.
                self.recorded.sort()
                records = [entry[3] for entry in self.recorded]
        else:
            made = [(rank, record) for _, rank, _, record in self.recorded]
            for judge, attempt, record in self._decided:
                record.number = _number(attempt)
                made.append((judge.compiled.rank, record))
            self._decided.clear()
            made.sort(key=lambda entry: _order(*entry))
            records = [record for _, record in made]
        self.recorded.clear()
        self.attempts += records
        return records

    def _number_new(self) -> None:
        for _, judge, attempt in sorted(self._started, key=_turn):
            name = judge.compiled.requirement.id
            attempt.number = self._counts[name] = self._counts.get(name, 0) + 1
        self._started.clear()
        for _, judge, attempt in sorted(self._doubtful, key=_turn):
            attempt.doubtful_number = self.next_doubtful(judge.compiled.requirement.id)
        self._doubtful.clear()


def verdict_at_end(
    judge: AttemptJudge, attempt: Open, end: int, reached: int
) -> tuple[Verdict, Decision]:
    """What becomes of an attempt that is undecided at the end of the trace."""
    passes = attempt.better is not None and attempt.better[0] == PASSED
    return settle_at_end(
        judge.compiled.requirement.at_end,
        held=not attempt.void and judge.held_at_end(attempt, end, reached),
        cannot_pass=attempt.void or attempt.token[0] == FAILED,
        cannot_fail=passes or not attempt.sure or attempt.clouded,
    )


def _record(
    judge: AttemptJudge,
    attempt: Open,
    decided: int | None,
    verdict: Verdict,
    decision: Decision,
    why: Explanation,
) -> Attempt:
    return Attempt(
        judge.compiled.requirement.id,
        _number(attempt),
        attempt.triggered,
        decided,
        verdict,
        decision,
        why.reason,
        why.deadline,
        values_shown(judge, attempt.seen),
        {} if decided is None else values_shown(judge, judge.seen),
        why.owed,
        judge.captured,
        why.blame,
        in_doubt=not attempt.sure,
    )


def _turn(entry: tuple[int, AttemptJudge, Open]) -> tuple[int, int, int]:
    t, judge, attempt = entry
    return t, attempt.triggered, judge.rank


def _number(attempt: Open) -> int:
    return attempt.number if attempt.sure else attempt.doubtful_number


def values_shown(judge: AttemptJudge, seen: tuple[int, ...]) -> dict[str, Scalar]:
    """The propositions concerned by their text; `None` is unknown."""
    return truths_shown([text for _, text in judge.leaves], seen)


def _order(rank: int, record: Attempt) -> tuple[bool, int, int, bool, int]:
    return (record.decided is None, record.decided or 0, rank, record.in_doubt, record.number)
