"""Open attempts as tokens of a machine."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rvmon.automaton.machine import Machine
from rvmon.formula.progress import after, holds_at_end
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Clerk, Open
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.plan.standing import Standing
from rvmon.trace.sample import Scalar


class MachineJudge(AttemptJudge):
    """Judges by the tokens of a machine.

    Args:
        compiled: as for `AttemptJudge`; so are the others.
        machine: judges the attempts.
        flow: gives the truth of the propositions.
        clerk: makes attempts and hears of decisions.
        captured: values of `let` and `for each`.
        **kind: `rank`, `hidden` and so on.
    """

    machine: Machine

    def __init__(
        self,
        compiled: CompiledRequirement,
        machine: Machine,
        flow: Standing,
        clerk: Clerk,
        captured: Mapping[str, Scalar],
        **kind: Any,
    ) -> None:
        super().__init__(compiled, machine, flow, clerk, captured, **kind)
        alphabet = compiled.alphabet
        worse = tuple(zip(self.places, alphabet.pessimistic, strict=True))
        better = tuple(zip(self.places, alphabet.optimistic, strict=True))

        def letters(values: list[int]) -> tuple[int, int]:
            return (
                sum([weights[values[place]] for place, weights in worse]),
                sum([weights[values[place]] for place, weights in better]),
            )

        self.letters = letters

    def held_at_end(self, attempt: Open, end: int, reached: int) -> bool:
        """See `AttemptJudge`."""
        location, anchors = attempt.token
        residual = after(self.machine.residual(location), [reached - a for a in anchors])
        return holds_at_end(residual, [end - a for a in anchors])
