"""Ways to get the truth of a formula at every tick, from peers and from rvmon."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from benchmarks.peers.client import Peer
from benchmarks.peers.dialects import ALWAYS_ONE, spelling, translate
from tests.tools.build import requirement, spec_over

from rvmon.language.checked.formula import EventAtom, Formula
from rvmon.language.checked.specification import CheckedSpec, TimeModel
from rvmon.session import Spec
from rvmon.testing.generate.numbers import Shape
from rvmon.testing.oracle import evaluate
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Kind
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Decision
from rvmon.verdicts.report import Report

Cell = bool | float | None
"""A value at a tick; `None`: not known."""

Columns = Mapping[str, Sequence[Cell]]
"""The values of each name, one per tick from tick 0 on."""


@dataclass(frozen=True, slots=True)
class Question:
    """A formula and a trace."""

    formula: Formula  # over the names of the columns
    columns: Columns  # all of one length
    # `held` or `sampled`; equivalent here, because there is a sample at every tick
    time: TimeModel = TimeModel.HELD

    @property
    def ticks(self) -> int:
        return len(next(iter(self.columns.values())))


@dataclass(frozen=True, slots=True)
class Way:
    """One way to ask one peer."""

    package: str  # its name in the package index
    adapter: str  # the adapter class
    kind: str  # time and semantics, for the adapter
    dialect: str  # the language of formulas
    time: TimeModel  # the equivalent time model of rvmon
    shape: Shape  # the operators of random formulas for this peer
    sign: bool = False  # whether it answers with a robustness, whose sign is the verdict; 0 is none

    def says(self, peer: Peer, question: Question) -> list[float | None]:
        """The answer of the peer at every tick.

        Raises:
            PeerError: the peer refuses, or its process ends.
            UntranslatableError: its language cannot express the formula.
        """
        text = translate(question.formula, self.dialect)
        ticks = question.ticks
        named = {spelling(name): list(column) for name, column in question.columns.items()}
        named[spelling("start")] = [tick == 0 for tick in range(ticks)]
        # For a robustness, `true` must be far from false.
        named[spelling(ALWAYS_ONE)] = [1e300 if self.sign else True] * ticks
        used = {name: column for name, column in named.items() if name in text}
        found: list[float | None]
        found = peer.ask("judge", formula=text, kind=self.kind, columns=used)["values"]
        return found

    def truths(self, peer: Peer, question: Question) -> list[bool | None]:
        """The peer's verdict at every tick; `None` where it has none."""
        values = self.says(peer, question)
        nothing = (None, 0) if self.sign else (None,)
        return [None if value in nothing else (value or 0) > 0 for value in values]


_HELD, _SAMPLED = TimeModel.HELD, TimeModel.SAMPLED
_FUTURE = Shape(past=False, numbers=False, events=False)
_BOTH = Shape(numbers=False, events=False)
_BOTH_STEP = Shape(step=True, numbers=False, events=False)
_PAST = Shape(future=False, numbers=False, events=False)
_PAST_STEP = Shape(step=True, future=False, numbers=False, events=False)
_REELAY, _RTAMT, _MSTLO = ("reelay", "Reelay"), ("rtamt", "Rtamt"), ("mstlo-python", "Mstlo")

WAYS = {
    "reelay-discrete": Way(*_REELAY, "discrete", "REELAY_DISCRETE", _SAMPLED, _PAST_STEP),
    "reelay-dense": Way(*_REELAY, "dense", "REELAY_DENSE", _HELD, _PAST),
    "rtamt-discrete": Way(*_RTAMT, "discrete", "RTAMT_DISCRETE", _SAMPLED, _BOTH_STEP, True),
    "rtamt-dense": Way(*_RTAMT, "dense", "RTAMT_DENSE", _HELD, _BOTH, True),
    "mstlo-delayed": Way(*_MSTLO, "DelayedQualitative", "MSTLO", _HELD, _FUTURE),
    "sentil": Way("sentil", "Sentil", "discrete", "SENTIL", _SAMPLED, _BOTH_STEP, True),
}

RTAMT_STEPPED = Way(*_RTAMT, "discrete online", "RTAMT_DISCRETE", _SAMPLED, _PAST_STEP, True)
"""rtamt row by row, as it is timed. It is not used for random formulas, because it steps a
subformula that occurs twice twice per row."""


Judge = Callable[[CheckedSpec, Sequence[Sample], int], Report]
"""Judges a specification on samples, with an `advance` to the given tick at the end."""


def ask_oracle(spec: CheckedSpec, samples: Sequence[Sample], end: int) -> Report:
    return evaluate(spec, samples, advances=(end,))


def ask_monitor(spec: CheckedSpec, samples: Sequence[Sample], end: int) -> Report:
    monitor = Spec(spec).monitor()
    for sample in samples:
        monitor.step_ns(sample.t, sample.values)
    monitor.advance_ns(end)
    return monitor.finish_ns(None)


def answers(question: Question, judge: Judge) -> list[bool | None]:
    """Our verdict at every tick, one attempt each; `None` if the trace does not decide it."""
    kinds: dict[str, Kind | None] = {
        name: Kind.REAL if float in map(type, column) else Kind.BOOL
        for name, column in question.columns.items()
    }
    asked = requirement(question.formula, upon=EventAtom("row"))
    spec = spec_over(kinds | {"row": None}, asked, question.time)
    rows = zip(*question.columns.values(), strict=True)
    samples = [
        Sample(tick, {"row": True, **dict(zip(question.columns, row, strict=True))})
        for tick, row in enumerate(rows)
    ]
    attempts = judge(spec, samples, question.ticks).attempts
    assert len(attempts) == question.ticks, f"{len(attempts)} attempts for {question.ticks} ticks"
    return [
        one.verdict is Verdict.PASS if one.decision is Decision.PREFIX else None
        for one in sorted(attempts, key=lambda one: one.triggered)
    ]
