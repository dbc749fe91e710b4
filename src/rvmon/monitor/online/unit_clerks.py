"""Clerks of generated code: they hear of its attempts and decisions, and write the records."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from operator import itemgetter
from typing import Any

from rvmon.automaton.location import Token
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open
from rvmon.monitor.attempts.machine_judge import MachineJudge
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.records.deferred_reasons import DeferredReasons
from rvmon.monitor.records.ledger import Ledger
from rvmon.plan.outages import Outage
from rvmon.plan.plan import Plan
from rvmon.runtime.rule import Rule
from rvmon.runtime.unit import Unit
from rvmon.verdict.attempt import decided_attempt
from rvmon.verdict.verdict import Verdict

_PASS, _FAIL = Verdict.PASS, Verdict.FAIL

Pick = Callable[[list[Any]], tuple[Any, ...]]
Noted = Callable[..., tuple[Any, ...]]


class UnitStanding:
    """The values that generated code works out; see `rvmon.plan.standing.Standing`."""

    begun = None
    is_cut = False

    def __init__(self, plan: Plan, unit: Unit) -> None:
        self.graph = plan.graph
        self.gap = plan.gap
        self.values = unit.v
        self.since = unit.since
        self._unit = unit

    @property
    def position(self) -> int:
        """See `Standing`."""
        return self._unit.position

    @property
    def outages(self) -> Mapping[str, Outage]:
        """See `Standing`."""
        found: Mapping[str, Outage] = self._unit.clerk.outages.now
        return found

    def last_with(self, place: int, value: int, t: int) -> int | None:
        """See `Standing`; of the propositions that a requirement owes."""
        return t if self.values[place] == value else self._unit.until[3 * place + value]


class JudgeClerk:
    """Tells generated code of all that a ledger hears from a rule that is no part of it."""

    def __init__(self, unit: Unit, ledger: Ledger) -> None:
        self._unit = unit
        self._ledger = ledger

    def opened(self, judge: AttemptJudge, triggered: int, token: Token, sure: bool) -> Open:
        """See `rvmon.monitor.attempts.attempt_judge.Clerk`."""
        self._unit.news = True  # it is numbered where decisions are looked for
        return self._ledger.opened(judge, triggered, token, sure)

    def assured(self, judge: AttemptJudge, attempt: Open) -> None:
        """See `rvmon.monitor.attempts.attempt_judge.Clerk`."""
        self._unit.news = True
        self._ledger.assured(judge, attempt)

    def parted(self, judge: AttemptJudge, attempt: Open, apart: bool) -> None:
        """See `rvmon.monitor.attempts.attempt_judge.Clerk`."""
        self._ledger.parted(judge, attempt, apart)

    def decided(
        self, judge: AttemptJudge, attempt: Open, verdict: bool, t: int, before: Token
    ) -> None:
        """See `rvmon.monitor.attempts.attempt_judge.Clerk`."""
        self._unit.news = True
        self._ledger.decided(judge, attempt, verdict, t, before)


class UnitClerk(DeferredReasons):
    """Stands where the judge of a requirement would, and writes the records of its decisions.

    Attributes:
        id: of the requirement.
    """

    def __init__(
        self,
        compiled: CompiledRequirement,
        plan: Plan,
        unit: Unit,
        standing: UnitStanding,
        ledger: Ledger,
        counts: list[int],
        noted: Noted,
    ) -> None:
        super().__init__(compiled, plan, ledger)
        self._ledger = ledger
        self._unit = unit
        self._standing = standing
        self._record = ledger.recorded.append
        self._counts = counts
        self._seen_of = _picking(self.leaves)
        self._noted = noted
        self._noted_last: tuple[Any, ...] = ()
        self.id = compiled.requirement.id
        self._rank = compiled.rank
        self._upon_end = compiled.obligation.trigger is None

    def judge_now(self, rule: Rule) -> MachineJudge:
        """The judge of the requirement, as it would stand now if it had judged."""
        letters = rule.letter, rule.other
        return self.judge(self._standing, letters, rule.position, rule.undecided())

    # What the unit calls.

    def opened(self, rule: Rule, triggered: int, token: Token, sure: bool) -> Open:
        """A new attempt; `sure`: its trigger was true."""
        attempt = Open(triggered, token, self._seen_of(self._unit.v))
        if sure:
            attempt.sure = True
            self._counts[rule.index] += 1
            attempt.number = self._counts[rule.index]
        else:
            attempt.doubtful_number = self._ledger.next_doubtful(self.id)
        if rule.hidden:
            attempt.doubt = self.judge_now(rule).doubt
        return attempt

    def assured(self, rule: Rule, attempt: Open) -> None:
        """Hear that the trigger of an attempt was true, which was unknown before."""
        self._counts[rule.index] += 1
        attempt.number = self._counts[rule.index]

    def entered(self, rule: Rule) -> tuple[int, tuple[int, ...]]:
        """The number of a new attempt, and what it sees at its trigger."""
        counts = self._counts
        number = counts[rule.index] = counts[rule.index] + 1
        return number, self._seen_of(self._unit.v)

    def reopened(
        self, _: Rule, number: int, triggered: int, token: Token, seen: tuple[int, ...] | int
    ) -> Open:
        """An attempt that was moved together with others, by itself; it is sure."""
        attempt = Open(triggered, token, self.unpacked(seen))
        attempt.number = number
        attempt.sure = True
        return attempt

    def parted(self, rule: Rule, attempt: Open, apart: bool) -> None:
        """Hear that unknown input made the two runs of an attempt part, or that they met."""
        if not rule.hidden:
            attempt.doubt = self.judge_now(rule).doubt if apart else None
        self._unit.news = True

    def decided(self, rule: Rule, attempt: Open, verdict: bool, t: int, before: Token) -> None:
        """Hear of a decision; see `rvmon.monitor.attempts.attempt_judge.Clerk`."""
        if verdict and attempt.void:
            self._ledger.say_nothing(self.judge_now(rule), attempt)
            self._unit.news = True  # no record, but something that is kept; so it is below
            return
        if not attempt.sure:
            return  # met, triggered or not
        self.decided_in_run(
            rule, attempt.number, attempt.triggered, attempt.seen, verdict, t, before
        )

    def decided_in_run(
        self,
        rule: Rule,
        number: int,
        triggered: int,
        seen: tuple[int, ...] | int,
        verdict: bool,
        t: int,
        before: Token,
    ) -> None:
        """Write the record of a decision.

        Args:
            rule: judged it.
            number: of the attempt.
            triggered: the instant of its trigger.
            seen: what was seen there, perhaps packed.
            verdict: whether it passed.
            t: the instant of the decision.
            before: its token before that; the anchors may be `FROM_TRIGGER`.
        """
        unit = self._unit
        unit.news = True
        decided = triggered if self._upon_end else t
        noted = self._noted(seen, t, before, rule, unit.v, unit.since, unit.until)
        if noted == self._noted_last:
            noted = self._noted_last  # of many that one letter decides, it is kept once
        else:
            self._noted_last = noted
        record = decided_attempt(
            self.id, number, triggered, decided, _PASS if verdict else _FAIL, self.details, noted
        )
        self._record((decided, self._rank, number, record))


def _picking(places: tuple[int, ...]) -> Pick:
    """A function that takes the entries at these places out of a list."""
    if not places:
        return lambda _: ()
    if len(places) == 1:
        (place,) = places
        return lambda values: (values[place],)
    return itemgetter(*places)
