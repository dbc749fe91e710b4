"""A requirement that a judge of its own judges, fed by generated code."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rvmon.automaton.machine import Token
from rvmon.codegen.unit_plan import Plan
from rvmon.dataflow.flow import Flow
from rvmon.dataflow.outages import Outage
from rvmon.monitor.attempt_judge import AttemptJudge, Clerk, Open
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.monitor.episode import Episode
from rvmon.monitor.judge import Judge
from rvmon.monitor.ledger import Ledger
from rvmon.monitor.network_judge import NetworkJudge
from rvmon.runtime.rule import Rule
from rvmon.runtime.unit import Unit


class Standing(Flow):
    """The values that generated code works out, as a judge of rvmon reads them.

    Args:
        plan: of the generated code.
        unit: of that plan; has begun a run.
    """

    def __init__(self, plan: Plan, unit: Unit) -> None:
        self.graph = plan.graph
        self.gap = plan.gap
        self.values = unit.v
        self.since = unit.since
        self._unit = unit
        self.follow()

    def follow(self) -> None:
        """Stand where the generated code stands now."""
        self.origin, self.position = self._unit.origin, self._unit.position

    @property
    def outages(self) -> Mapping[str, Outage]:
        """See `Flow.outages`."""
        found: Mapping[str, Outage] = self._unit.clerk.outages
        return found

    def last_with(self, place: int, value: int, t: int) -> int | None:
        """See `Flow.last_with`; of the propositions that a requirement owes."""
        if self.values[place] == value:
            return t
        found: int | None = self._unit.until[3 * place + value]
        return found


class FedJudge(Rule):
    """Stands where generated code drives attempts, and leaves that to a judge.

    Args:
        index: of the rule in the unit.
        compiled: the requirement, or what judges its attempts in doubt.
        plan: of the generated code.
        unit: of that plan; has begun a run.
        ledger: takes the records.
    """

    __slots__ = ("_compiled", "_episode", "_judge", "_ledger", "_plan", "_standing", "_unit")

    STATE = ("_judge", "_episode", "due", "restless", "before", "running", "failed_at", "eyed")

    def __init__(
        self, index: int, compiled: CompiledRequirement, plan: Plan, unit: Unit, ledger: Ledger
    ) -> None:
        _, letters, *kind = unit.RULES[index]
        given: list[Any] = [index, None, letters, *kind, unit.GAP, unit.v, None]
        super().__init__(*given)
        self._compiled = compiled
        self._plan = plan
        self._ledger = ledger
        self._unit = unit
        self._standing: Standing | None = None
        self._judge: AttemptJudge | None = None
        self._episode: Episode | None = None

    @property
    def judge(self) -> AttemptJudge:
        """Has the open attempts; it is made when it is first asked for."""
        if self._judge is None:
            self._standing = Standing(self._plan, self._unit)
            hearing = _Hearing(self._unit, self._ledger)
            self._judge = judge = _judge(self._compiled, self._standing, hearing)
            # Whether there is somebody to visit is known to the judge.
            self.runs = {0: judge}
            if self.episodic and not self.hidden:
                self._episode = Episode(
                    judge,
                    self._standing,
                    doubted=False,
                    start=lambda attempt: self._ledger.doubtful(0, judge, attempt),
                    sure=lambda attempt, t: self._ledger.sure(0, judge, attempt, t),
                )
                self._episode.resume = self._resume
        return self._judge

    def _resume(self, episode: Episode) -> None:
        if self.again >= 0:
            self.failed_at = episode.failed_at

    def stand(self) -> None:
        """Let the judge see where the generated code stands now."""
        if self._standing is not None:
            self._standing.follow()

    def begin(self, t: int, triggered: int) -> None:
        """Start an attempt at the position `t`, at which the values are."""
        judge = self.judge
        self.stand()
        if self._episode is not None:
            self.failed_at = None
            self.eyed = True
            self._episode.begin(t, triggered)
        else:
            attempt = judge.new_attempt(t, triggered)
            if self.hidden:
                self._ledger.doubtful(0, judge, attempt)
            else:
                attempt.sure = True
                self._ledger.sure(0, judge, attempt, triggered)
            judge.begin(attempt, t)
        self._unit.news = True  # it is numbered where decisions are looked for
        self._note()

    def look(self) -> None:
        """See the trigger before the attempts do."""
        if self._episode is not None:
            self.stand()
            self._episode.look(self._standing.position if self._standing else 0)
            self._unit.news = True

    def goes_on(self, _: int) -> bool:
        """Whether what is owed has not failed at once at a position, at which the values are."""
        return self._episode is not None and self._episode.may_go_on

    def settle_flags(self) -> None:
        """Come to the end."""
        if self._episode is not None:
            self.stand()
            self._episode.close()

    def visit(self, t: int) -> None:
        """Take all attempts to the position `t`, at which the values are."""
        self.stand()
        self.judge.visit(t)
        self._note()

    def pass_to(self, t: int) -> None:
        """Let time come to `t` with the letters as they are; positions up to there are stepped."""
        if self._judge is not None:
            self.stand()
            self._judge.pass_to(t)
            self._note()

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which the letter is not known, from the instant before."""
        if self._judge is not None:
            self.stand()
            self._judge.reach(t)
            self._note()

    def _note(self) -> None:
        self.due = self.judge.due
        self.restless = self.judge.restless


class _Hearing:
    """Tells generated code that something was decided, and the ledger what.

    Args:
        unit: looks for news after each step.
        ledger: takes the records.
    """

    def __init__(self, unit: Unit, ledger: Ledger) -> None:
        self._unit = unit
        self._ledger = ledger

    def decided(
        self, judge: AttemptJudge, attempt: Open, verdict: bool, t: int, before: Token
    ) -> None:
        """See `rvmon.monitor.attempt_judge.Clerk`."""
        self._unit.news = True
        self._ledger.decided(judge, attempt, verdict, t, before)


def _judge(compiled: CompiledRequirement, flow: Flow, clerk: Clerk) -> AttemptJudge:
    # No automaton is built while a monitor runs, as it would be here for attempts in doubt.
    if compiled.is_beside or compiled.automaton is None:
        return NetworkJudge(compiled, compiled.network_plan, flow, clerk, {})
    return Judge(compiled, compiled.machine("auto"), flow, clerk, {})
