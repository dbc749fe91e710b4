"""A requirement that a judge of its own judges, fed by generated code."""

from __future__ import annotations

from collections.abc import Mapping

from rvmon.automaton.machine import Token
from rvmon.codegen.plan import Plan
from rvmon.codegen.runtime.rule import Rule
from rvmon.codegen.runtime.unit import Unit
from rvmon.dataflow.flow import Flow
from rvmon.dataflow.outages import Outage
from rvmon.monitor.bench import Bench, Clerk, Open
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.monitor.judge import Judge
from rvmon.monitor.ledger import Ledger
from rvmon.monitor.network_judge import NetworkJudge


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


class HostedRule(Rule):
    """Stands where generated code drives attempts, and leaves that to a judge.

    Args:
        index: of the requirement in the plan.
        compiled: the requirement.
        plan: of the generated code.
        unit: of that plan; has begun a run.
        ledger: takes the records.

    Attributes:
        judge: has the open attempts.
    """

    __slots__ = ("_ledger", "_standing", "_unit", "judge")

    def __init__(
        self, index: int, compiled: CompiledRequirement, plan: Plan, unit: Unit, ledger: Ledger
    ) -> None:
        _, letters, _, pulse, episodic = unit.RULES[index]
        super().__init__(index, None, letters, pulse, episodic, unit.GAP, unit.v, None)
        self._ledger = ledger
        self._unit = unit
        self._standing = Standing(plan, unit)
        self.judge = _judge(compiled, self._standing, _Hearing(unit, ledger))
        # Whether there is somebody to visit is known to the judge.
        self.runs = {0: self.judge}

    def stand(self) -> None:
        """Let the judge see where the generated code stands now."""
        self._standing.follow()

    def begin(self, t: int, triggered: int) -> None:
        """Start an attempt at the position `t`, at which the values are."""
        self.stand()
        self._ledger.started(0, self.judge, self.judge.begin(t, triggered))
        self._unit.news = True  # it is numbered where decisions are looked for
        self._note()

    def visit(self, t: int) -> None:
        """Take all attempts to the position `t`, at which the values are."""
        self.stand()
        self.judge.visit(t)
        self._note()

    def pass_to(self, t: int) -> None:
        """Let time come to `t` with the letters as they are; positions up to there are stepped."""
        self.stand()
        self.judge.pass_to(t)
        self._note()

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which the letter is not known, from the instant before."""
        self.stand()
        self.judge.reach(t)
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

    def decided(self, judge: Bench, attempt: Open, verdict: bool, t: int, before: Token) -> None:
        """See `rvmon.monitor.bench.Clerk`."""
        self._unit.news = True
        self._ledger.decided(judge, attempt, verdict, t, before)


def _judge(compiled: CompiledRequirement, flow: Flow, clerk: Clerk) -> Bench:
    if compiled.automaton is None:
        return NetworkJudge(compiled, compiled.network_plan, flow, clerk, {})
    return Judge(compiled, compiled.machine("auto"), flow, clerk, {})
