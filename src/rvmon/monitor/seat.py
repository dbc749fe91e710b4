"""What is told of the attempts of one requirement that generated code judges."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from operator import itemgetter
from typing import Any

from rvmon.automaton.machine import Token
from rvmon.codegen.plan import Plan
from rvmon.codegen.runtime.rule import Rule
from rvmon.codegen.runtime.unit import Unit
from rvmon.dataflow.flow import Flow
from rvmon.monitor.bench import Clerk, Open
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.monitor.explain import explain_decision
from rvmon.monitor.judge import Judge
from rvmon.monitor.ledger import values_shown
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
        clerk: whom a judge would tell.
    """

    def __init__(self, compiled: CompiledRequirement, plan: Plan, unit: Unit, clerk: Clerk) -> None:
        self.compiled = compiled
        self._unit = unit
        self._clerk = clerk
        graph = plan.graph
        places = tuple(graph.index[state] for state in compiled.alphabet.propositions)
        leaves = tuple(graph.index[leaf] for leaf, _ in compiled.leaves if leaf in graph.index)
        self.seen = _picking(leaves)
        """Gives the values of what it reads, from those of all nodes."""
        self._leaves = leaves
        self.leaf_count = len(leaves)
        self._places = places
        self._values_of = _picking(places)
        self._since_of = _picking(places)
        self._until_of = _picking(tuple(3 * place + truth for place in places for truth in (0, 2)))
        self._plan = plan
        self._id = compiled.requirement.id
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
        judge = Judge(self.compiled, self.compiled.machine("auto"), flow, self._clerk, {})
        judge.letters = letters
        judge.position = position
        judge.attempts = attempts
        return judge

    def decided(
        self,
        rule: Rule,
        number: int,
        triggered: int,
        seen: tuple[int, ...] | int,
        verdict: bool,
        t: int,
        before: Token,
    ) -> Attempt:
        """The record of a decision.

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
        v = unit.v
        return decided_attempt(
            self._id,
            number,
            triggered,
            triggered if self._upon_end else t,
            _PASS if verdict else _FAIL,
            self.details,
            # One flat tuple, which costs the collector of garbage next to nothing.
            (
                *(seen, t, before, rule.letter, rule.other, rule.position),
                *self.seen(v),
                *self._values_of(v),
                *self._since_of(unit.since),
                *self._until_of(unit.until),
            ),
        )

    def _details(self, attempt: Attempt, noted: tuple[Any, ...]) -> Mapping[str, Any]:
        """All that a record says beside the verdict, from what was noted at the decision."""
        seen_then, t, before, letter, other, position, *rest = noted
        if isinstance(seen_then, int):
            seen_then = unpacked(seen_then, self.leaf_count)
        count = len(self._places)
        seen = tuple(rest[: self.leaf_count])
        values, since = rest[self.leaf_count :][:count], rest[self.leaf_count + count :][:count]
        until = rest[self.leaf_count + 2 * count :]
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


def packed(truths: tuple[int, ...]) -> int:
    """Truth values as one number.

    >>> unpacked(packed((2, 0, 1)), 3)
    (2, 0, 1)
    """
    number = 0
    for truth in truths:
        number = 3 * number + truth
    return number


def unpacked(number: int, count: int) -> tuple[int, ...]:
    """So many truth values that `packed` made one number of."""
    truths = []
    for _ in range(count):
        number, truth = divmod(number, 3)
        truths.append(truth)
    return tuple(reversed(truths))
