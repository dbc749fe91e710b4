"""What is told of the attempts of one requirement that generated code judges."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from operator import itemgetter
from typing import Any

from rvmon.automaton.machine import Token
from rvmon.codegen.plan import Plan
from rvmon.codegen.runtime.bulk import unpacked
from rvmon.codegen.runtime.rule import Rule
from rvmon.codegen.runtime.unit import Unit
from rvmon.dataflow.flow import Flow
from rvmon.monitor.bench import Open
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.monitor.explain import explain_decision
from rvmon.monitor.judge import Judge
from rvmon.monitor.ledger import Ledger, values_shown
from rvmon.verdict.attempt import Attempt, decided_attempt
from rvmon.verdict.verdict import Verdict

_PASS, _FAIL = Verdict.PASS, Verdict.FAIL

Pick = Callable[[list[Any]], tuple[Any, ...]]


class Seat:
    """Stands where the judge of a requirement would, and writes the records of its decisions.

    A record costs little until someone asks for its reason: what that needs is noted.

    Args:
        compiled: the requirement.
        plan: that it is part of.
        unit: judges it.
        ledger: takes the records.
        counts: of the attempts of all requirements.
    """

    def __init__(
        self,
        compiled: CompiledRequirement,
        plan: Plan,
        unit: Unit,
        ledger: Ledger,
        counts: list[int],
    ) -> None:
        self._compiled = compiled
        self._unit = unit
        self._ledger = ledger
        self._told = ledger.told
        self._counts = counts
        graph = plan.graph
        places = tuple(graph.index[state] for state in compiled.alphabet.propositions)
        leaves = tuple(graph.index[leaf] for leaf, _ in compiled.leaves if leaf in graph.index)
        self._seen_of = _picking(leaves)
        self._leaves = leaves
        self._places = places
        self._values_of = _picking((*leaves, *places))
        self._since_of = _picking(places)
        self._until_of = _picking(tuple(3 * place + truth for place in places for truth in (0, 2)))
        self._plan = plan
        self._id = compiled.requirement.id
        self._rank = compiled.rank
        self._upon_end = compiled.obligation.trigger is None
        self.details = self._details

    def judge_now(self, rule: Rule) -> Judge:
        """The judge of the requirement, as it would stand now if it had judged."""
        unit = self._unit
        flow = _Stood(self._plan, unit.v, unit.since, unit.until)
        flow.origin, flow.position = unit.origin, unit.position
        return self._judge(flow, (rule.letter, rule.other), rule.position, rule.undecided())

    def _judge(
        self, flow: Flow, letters: tuple[int, int], position: int, attempts: list[Open]
    ) -> Judge:
        judge = Judge(self._compiled, self._compiled.machine("auto"), flow, self._ledger, {})
        judge.letters = letters
        judge.position = position
        judge.attempts = attempts
        return judge

    # What the unit calls.

    def opened(self, rule: Rule, triggered: int, token: Token) -> Open:
        """A new attempt."""
        attempt = Open(triggered, token, self._seen_of(self._unit.v))
        self._counts[rule.index] += 1
        attempt.number = self._counts[rule.index]
        return attempt

    def entered(self, rule: Rule) -> tuple[int, tuple[int, ...]]:
        """The number of a new attempt, and what it sees at its trigger."""
        counts = self._counts
        number = counts[rule.index] = counts[rule.index] + 1
        return number, self._seen_of(self._unit.v)

    def reopened(
        self, _: Rule, number: int, triggered: int, token: Token, seen: tuple[int, ...] | int
    ) -> Open:
        """An attempt that was moved together with others, by itself."""
        attempt = Open(triggered, token, self._unpacked(seen))
        attempt.number = number
        return attempt

    def parted(self, rule: Rule, attempt: Open) -> None:
        """Hear that unknown input made the two runs of an attempt part."""
        attempt.doubt = self.judge_now(rule)._doubt()

    def decided(self, rule: Rule, attempt: Open, verdict: bool, t: int, before: Token) -> None:
        """Hear of a decision; see `rvmon.monitor.bench.Clerk`."""
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
            before: its token before that.
        """
        unit = self._unit
        unit.news = True
        self._told(
            self._rank,
            decided_attempt(
                self._id,
                number,
                triggered,
                triggered if self._upon_end else t,
                _PASS if verdict else _FAIL,
                self.details,
                # One flat tuple, which costs the collector of garbage next to nothing.
                (
                    *(seen, t, before, rule.letter, rule.other, rule.position),
                    *self._values_of(unit.v),
                    *self._since_of(unit.since),
                    *self._until_of(unit.until),
                ),
            ),
        )

    # What others ask.

    def _unpacked(self, seen: tuple[int, ...] | int) -> tuple[int, ...]:
        return unpacked(seen, len(self._leaves)) if isinstance(seen, int) else seen

    def _details(self, attempt: Attempt, noted: tuple[Any, ...]) -> Mapping[str, Any]:
        """All that a record says beside the verdict, from what was noted at the decision."""
        seen_then, t, before, letter, other, position, *rest = noted
        seen_then = self._unpacked(seen_then)
        leaves, count = len(self._leaves), len(self._places)
        seen = tuple(rest[:leaves])
        values, since = rest[leaves:][:count], rest[leaves + count :][:count]
        until = rest[leaves + 2 * count :]
        nodes: dict[int, int] = dict(zip(self._leaves, seen, strict=True))
        nodes |= zip(self._places, values, strict=True)
        instants = {}
        for index, place in enumerate(self._places):
            instants[3 * place], instants[3 * place + 2] = until[2 * index : 2 * index + 2]
        flow = _Stood(self._plan, nodes, dict(zip(self._places, since, strict=True)), instants)
        judge = self._judge(flow, (letter, other), position, [])
        opened = Open(attempt.triggered, before, seen_then)
        why = explain_decision(judge, opened, attempt.verdict is _PASS, t, before)
        return {
            "reason": why.reason,
            "deadline": why.deadline,
            "at_trigger": values_shown(judge, seen_then),
            "at_decision": values_shown(judge, seen),
            "owed": why.owed,
            "captured": {},
            "blame": why.blame,
            "forecast": None,
            "robustness": None,
        }


class _Stood(Flow):
    """A flow as it stood: it tells, and does not go on."""

    def __init__(self, plan: Plan, values: Any, since: Any, until: Any) -> None:
        self.graph = plan.graph
        self.gap = plan.gap
        self.values = values
        self.since = since
        self._instants = until

    def last_with(self, place: int, value: int, t: int) -> int | None:
        """See `Flow.last_with`; of the propositions that the requirement owes."""
        found: int | None = t if self.values[place] == value else self._instants[3 * place + value]
        return found


def _picking(places: tuple[int, ...]) -> Pick:
    """A function that takes the entries at these places out of a list."""
    if not places:
        return lambda _: ()
    if len(places) == 1:
        (place,) = places
        return lambda values: (values[place],)
    return itemgetter(*places)
