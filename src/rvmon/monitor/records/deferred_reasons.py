"""What is reported of a decision, from what was noted when it was made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

from rvmon.automaton.machine import Machine
from rvmon.monitor.attempts.attempt_judge import Clerk, Open
from rvmon.monitor.attempts.machine_judge import MachineJudge
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.explained.explanation import truths_shown
from rvmon.monitor.explained.findings import Reasons
from rvmon.monitor.explained.machine import explained
from rvmon.monitor.records.explain_machine import just_before
from rvmon.plan.plan import Plan
from rvmon.plan.standing import Standing
from rvmon.plan.stood import Stood
from rvmon.runtime.bulk import FROM_TRIGGER, unpacked
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict


class DeferredReasons:
    """Tells of the decisions of one requirement that something else than its judge has made.

    A record costs little until someone asks for its reason: what that needs is noted.

    Attributes:
        leaves: the nodes of the plan that it reads of the input.
        places: the nodes of the plan that its letters are made of.
        texts: of the leaves.
    """

    def __init__(self, compiled: CompiledRequirement, plan: Plan, clerk: Clerk) -> None:
        self.compiled = compiled
        self._plan = plan
        self._clerk = clerk
        index = plan.graph.index
        self.places = tuple(index[state] for state in compiled.alphabet.propositions)
        read = [(index[leaf], text) for leaf, text in compiled.leaves if leaf in index]
        self.leaves = tuple(leaf for leaf, _ in read)
        self.texts = tuple(text for _, text in read)

    @cached_property
    def _machine(self) -> Machine:
        return self.compiled.machine("automaton")

    @cached_property
    def reasons(self) -> Reasons:
        """Of its decisions; they are rarely asked for where attempts are in doubt."""
        return Reasons(self.compiled, self._machine)

    def judge(
        self,
        flow: Standing,
        letters: tuple[int, int],
        position: int,
        attempts: list[Open],
    ) -> MachineJudge:
        """The judge of the requirement, as it would stand if it had judged."""
        judge = MachineJudge(self.compiled, self._machine, flow, self._clerk, {})
        judge.letter, judge.other = letters
        judge.position = position
        judge.attempts = attempts
        return judge

    def unpacked(self, seen: tuple[int, ...] | int) -> tuple[int, ...]:
        """The values of the leaves, where they may be packed."""
        return unpacked(seen, len(self.leaves)) if isinstance(seen, int) else seen

    def stood(self, noted: Sequence[Any], position: int) -> tuple[tuple[int, ...], Stood]:
        """What was read of the input at a position, and how the propositions stood.

        Args:
            noted: the truths of the leaves, then those of the propositions, since when they had
                them, and when they were false and true before.
            position: ticks.
        """
        leaves, count = len(self.leaves), len(self.places)
        seen = tuple(noted[:leaves])
        values, since = noted[leaves:][:count], noted[leaves + count :][:count]
        until = noted[leaves + 2 * count :]
        nodes: dict[int, int] = dict(zip(self.leaves, seen, strict=True))
        nodes |= zip(self.places, values, strict=True)
        instants = {}
        for index, place in enumerate(self.places):
            instants[3 * place], instants[3 * place + 2] = until[2 * index : 2 * index + 2]
        kept = dict(zip(self.places, since, strict=True))
        return seen, Stood(self._plan, nodes, kept, instants, {}, position)

    def details(self, attempt: Attempt, noted: tuple[Any, ...]) -> Mapping[str, Any]:
        """All that a record says beside the verdict, from what was noted at the decision."""
        seen_then, t, before, letter, other, position, *rest = noted
        seen_then = self.unpacked(seen_then)
        if before[1] == FROM_TRIGGER:
            before = (before[0], (attempt.triggered,))
        seen, flow = self.stood(rest, position)
        passed = attempt.verdict is Verdict.PASS
        letter = letter if passed else other
        token = just_before(self._machine, before, letter, position, t, self._plan.gap)
        why = explained(self.reasons, token, letter, passed, t, attempt.triggered, flow)
        return {
            "reason": why.reason,
            "deadline": why.deadline,
            "at_trigger": truths_shown(self.texts, seen_then),
            "at_decision": truths_shown(self.texts, seen),
            "owed": why.owed,
            "captured": {},
            "blame": why.blame,
            "forecast": None,
            "robustness": None,
        }
