"""Captured values that may be others: an attempt may have begun later than was seen."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rvmon.formula.state import FALSE, UNKNOWN
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open, doubt_in, leaves_in
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.plan.numbers import events_of
from rvmon.runtime.expressions import reader
from rvmon.spec.checked.formula import Numeric
from rvmon.trace.sample import Payload, Scalar

Captured = Mapping[str, Scalar]


class CapturedAttempt:
    """Compares what an attempt has captured with what it may have captured.

    Args:
        parent: the evaluator in which it was triggered.
        compiled: its requirement.
        captured: its values.
        trigger: place of the trigger in the parent's flow: where that is FALSE, it is over.
        doubt: place there of what is UNKNOWN where it may have begun; `None`: anywhere.

    Attributes:
        evaluator: its own.

    Source: SEMANTICS, section 3 (Doubt, `let`); decision record 4.
    """

    def __init__(
        self,
        parent: Evaluator,
        compiled: CompiledRequirement,
        captured: Captured,
        trigger: int,
        doubt: int | None,
    ) -> None:
        self._parent = parent
        self.evaluator = parent
        self._own = captured
        self._captures = compiled.requirement.captures
        self._leaves = leaves_in(parent.graph, compiled)
        self._trigger = trigger
        self._doubt = doubt

    def follow(self, evaluator: Evaluator) -> None:
        """Take the evaluator that is its own."""
        self.evaluator = evaluator
        self._parent.watched.append(self)

    @property
    def may_begin_otherwise(self) -> bool:
        """Whether it may have begun at this position, with other values."""
        doubt = self._doubt
        return (doubt is None or self._parent.v[doubt] == UNKNOWN) and not self._is_same

    def keeps(self, t: int) -> bool:
        """See `rvmon.monitor.attempts.evaluator.WatchedAttempt`."""
        evaluator = self.evaluator
        trigger = self._parent.v[self._trigger]
        if evaluator.is_idle or trigger == FALSE:
            evaluator.blurs = False
        elif evaluator.blurs and not evaluator.is_cut and self.may_begin_otherwise:
            evaluator.cut_at(t)
        if evaluator.cut == t:
            doubt = doubt_in(self._parent, self._leaves, t)
            for _, attempt in self._attempts:
                attempt.doubt = attempt.doubt or doubt
        for judge, attempt in self._attempts if evaluator.is_cut else ():
            attempt.void = True
            # Its own evaluator can no longer see whether it is over.
            clouded = attempt.clouded or judge.clouded or trigger == UNKNOWN
            attempt.clouded = trigger != FALSE and clouded
        return evaluator.blurs or (evaluator.is_cut and trigger != FALSE)

    @property
    def _attempts(self) -> Iterator[tuple[AttemptJudge, Open]]:
        return ((judge, attempt) for judge in self.evaluator.judges for attempt in judge.attempts)

    @property
    def _is_same(self) -> bool:
        own, known = self._own, dict(self._own)
        for capture in self._captures:
            known[capture.name] = captured_value(capture.value, self._parent, known)
        return all(
            known[one.name] is not None and known[one.name] == own[one.name]
            for one in self._captures
        )


def captured_value(value: Numeric, evaluator: Evaluator, captured: Captured) -> Scalar:
    """The value of an expression at an evaluator's position; of several payloads, of the last."""
    payloads: dict[str, Payload] = {}
    for event in events_of(value):
        found = evaluator.payloads_of(event)
        payloads[event] = (found[-1] if found else None) or {}
    return reader(value, evaluator, captured)(payloads)
