"""What judges a requirement, or starts what does."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Clerk
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.attempts.machine_judge import MachineJudge
from rvmon.monitor.attempts.network_judge import NetworkJudge
from rvmon.monitor.attempts.window_judge import WindowJudge
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.plan.standing import Standing
from rvmon.runtime.rule import Rule
from rvmon.spec.checked.specification import Mode
from rvmon.trace.sample import Scalar

Start = Callable[[int, int], None]
"""Starts an attempt; takes the position and the instant of the trigger."""


def judge_of(
    compiled: CompiledRequirement,
    engine: str,
    standing: Standing,
    clerk: Clerk,
    captured: Mapping[str, Scalar],
    **kind: Any,
) -> AttemptJudge:
    """What judges the attempts of a requirement, or those of it that are in doubt.

    Args:
        compiled: as for `AttemptJudge`; so are the others.
        engine: judges them. For those in doubt no automaton is built while a monitor runs.
        standing: gives the truth of the propositions.
        clerk: makes attempts and hears of decisions.
        captured: values of `let` and `for each`.
        **kind: `rank`, `hidden` and so on.
    """
    if compiled.is_beside or compiled.engine(engine) == "network":
        if compiled.windows is None:
            return NetworkJudge(compiled, standing, clerk, captured, **kind)
        return WindowJudge(compiled.windows, compiled, standing, clerk, captured, **kind)
    return MachineJudge(compiled, compiled.machine(engine), standing, clerk, captured, **kind)


class CapturingRule(Rule):
    """Starts the attempts of a requirement with captured values, each in an evaluator of its own.

    Args:
        compiled: the requirement, or what judges its attempts in doubt.
        evaluator: gives the truth of its trigger.
        start: makes the evaluator, and starts the attempt.
        hidden: whether these are the attempts in doubt.
    """

    def __init__(
        self, compiled: CompiledRequirement, evaluator: Evaluator, start: Start, *, hidden: bool
    ) -> None:
        trigger = compiled.obligation.trigger
        super().__init__(
            0,
            None,
            None,
            -1 if trigger is None else evaluator.graph.index[trigger],
            compiled.requirement.pulse,
            hidden or compiled.requirement.mode is Mode.WHENEVER,
            hidden,
            -1,
            -1,
            evaluator.gap,
            evaluator.values,
            None,
        )
        self._start = start

    def begin(self, t: int, triggered: int) -> None:
        """Start an attempt at the position `t`, at which the values are."""
        self._start(t, triggered)
