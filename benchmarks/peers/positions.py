"""The truth of a formula at every tick by ours: one attempt per tick, by the public interface."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from benchmarks.peers.ways import Columns

from rvmon.spec.checked.formula import EventAtom, Formula
from rvmon.spec.checked.specification import (
    CheckedSpec,
    Event,
    Mode,
    Requirement,
    Signal,
    TimeModel,
    Type,
)
from rvmon.trace.sample import Sample, Value
from rvmon.trace.schema import Kind
from rvmon.verdict import Verdict
from rvmon.verdict.attempt import Attempt, Decision
from rvmon.verdict.report import Report

ROW = "row"
"""The event of every sample, which starts an attempt."""


@dataclass(frozen=True, slots=True)
class Question:
    """A formula and a trace.

    Attributes:
        formula: over the names of the columns.
        columns: all of one length.
        events: the names among them that are events.
        time: `held` or `sampled`; the same here, as there is a sample at every tick.
    """

    formula: Formula
    columns: Columns
    events: frozenset[str]
    time: TimeModel

    @property
    def ticks(self) -> int:
        """The length of the trace."""
        return len(next(iter(self.columns.values())))


Judge = Callable[[CheckedSpec, Sequence[Sample], int], Report]
"""Judges a spec on samples, with an `advance` to the given tick at the end."""


def ask_oracle(spec: CheckedSpec, samples: Sequence[Sample], end: int) -> Report:
    """Judge by the reference oracle."""
    from rvmon.testing.oracle import evaluate

    return evaluate(spec, samples, advances=(end,))


def ask_monitor(spec: CheckedSpec, samples: Sequence[Sample], end: int) -> Report:
    """Judge by a monitor."""
    from rvmon.session import Spec

    monitor = Spec(spec).monitor()
    for sample in samples:
        monitor.step_ns(sample.t, sample.values)
    monitor.advance_ns(end)
    return monitor.finish_ns(None)


def answers(question: Question, judge: Judge) -> list[bool | None]:
    """TRUE, FALSE or `None` (not decided by the trace) at every tick."""
    report = judge(_spec(question), _samples(question), question.ticks)
    if len(report.attempts) != question.ticks:
        raise AssertionError(f"{len(report.attempts)} attempts for {question.ticks} ticks")
    by_tick = sorted(report.attempts, key=lambda attempt: attempt.triggered)
    return [_answer(attempt) for attempt in by_tick]


def _answer(attempt: Attempt) -> bool | None:
    if attempt.decision is not Decision.PREFIX:
        return None
    return attempt.verdict is Verdict.PASS


def _spec(question: Question) -> CheckedSpec:
    signals = {}
    for name, column in question.columns.items():
        if name not in question.events:
            kind = Kind.REAL if any(type(cell) is float for cell in column) else Kind.BOOL
            signals[name] = Signal(name, Type(kind))
    requirement = Requirement("R", Mode.UPON, EventAtom(ROW), question.formula, pulse=True)
    events = {name: Event(name) for name in (*sorted(question.events), ROW)}
    return CheckedSpec("question", "", question.time, signals, events, {"R": requirement})


def _samples(question: Question) -> list[Sample]:
    samples = []
    for tick in range(question.ticks):
        values: dict[str, Value] = {ROW: True}
        for name, column in question.columns.items():
            if name in question.events:
                if column[tick]:
                    values[name] = True
            elif tick == 0 or column[tick] != column[tick - 1]:
                values[name] = column[tick]
        samples.append(Sample(tick, values))
    return samples
