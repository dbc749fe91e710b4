"""The records of the decisions that generated code makes for one requirement."""

from __future__ import annotations

from collections.abc import Callable
from operator import itemgetter
from typing import Any

from rvmon.automaton.machine import Token
from rvmon.codegen.unit_plan import Plan
from rvmon.monitor.attempt_judge import Open
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.monitor.judge import Judge
from rvmon.monitor.ledger import Ledger
from rvmon.monitor.witness import Stood, Witness
from rvmon.runtime.rule import Rule
from rvmon.runtime.unit import Unit
from rvmon.verdict.attempt import decided_attempt
from rvmon.verdict.verdict import Verdict

_PASS, _FAIL = Verdict.PASS, Verdict.FAIL

Pick = Callable[[list[Any]], tuple[Any, ...]]
Noted = Callable[..., tuple[Any, ...]]


class GeneratedRecords(Witness):
    """Stands where the judge of a requirement would, and writes the records of its decisions.

    Args:
        compiled: the requirement.
        plan: that it is part of.
        unit: judges it.
        ledger: takes the records.
        counts: of the attempts of all requirements.
        noted: gives what a record keeps, see `rvmon.runtime.unit.Unit.NOTED`.
    """

    def __init__(
        self,
        compiled: CompiledRequirement,
        plan: Plan,
        unit: Unit,
        ledger: Ledger,
        counts: list[int],
        noted: Noted,
    ) -> None:
        super().__init__(compiled, plan, ledger)
        self._ledger = ledger
        self._unit = unit
        self._tell = ledger.told.append
        self._counts = counts
        self._seen_of = _picking(self.leaves)
        self._noted = noted
        self._noted_last: tuple[Any, ...] = ()
        self._id = compiled.requirement.id
        self._rank = compiled.rank
        self._upon_end = compiled.obligation.trigger is None

    def judge_now(self, rule: Rule) -> Judge:
        """The judge of the requirement, as it would stand now if it had judged."""
        unit = self._unit
        flow = Stood(self._plan, unit.v, unit.since, unit.until, unit.clerk.outages)
        flow.origin, flow.position = unit.origin, unit.position
        return self.judge(flow, (rule.letter, rule.other), rule.position, rule.undecided())

    # What the unit calls.

    def opened(self, rule: Rule, triggered: int, token: Token, sure: bool) -> Open:
        """A new attempt; `sure`: its trigger was true."""
        attempt = Open(triggered, token, self._seen_of(self._unit.v))
        if sure:
            attempt.sure = True
            self._counts[rule.index] += 1
            attempt.number = self._counts[rule.index]
        else:
            attempt.doubtful_number = self._ledger.next_doubtful(self._id)
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
        """An attempt that was moved together with others, by itself."""
        attempt = Open(triggered, token, self.unpacked(seen))
        attempt.number = number
        attempt.sure = True
        return attempt

    def parted(self, rule: Rule, attempt: Open) -> None:
        """Hear that unknown input made the two runs of an attempt part."""
        attempt.doubt = self.judge_now(rule)._doubt()
        self._unit.news = True

    def decided(self, rule: Rule, attempt: Open, verdict: bool, t: int, before: Token) -> None:
        """Hear of a decision; see `rvmon.monitor.attempt_judge.Clerk`."""
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
            self._id, number, triggered, decided, _PASS if verdict else _FAIL, self.details, noted
        )
        self._tell((decided, self._rank, number, record))


def _picking(places: tuple[int, ...]) -> Pick:
    """A function that takes the entries at these places out of a list."""
    if not places:
        return lambda _: ()
    if len(places) == 1:
        (place,) = places
        return lambda values: (values[place],)
    return itemgetter(*places)
