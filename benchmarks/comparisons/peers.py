"""Other monitors on random formulas of the common fragment: verdicts, robustness, tick by tick."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from benchmarks.comparisons.comparison import Comparison, Found
from benchmarks.peers.client import Peer, PeerError
from benchmarks.peers.contest import CONTESTS, Contest, ask_peer, random_question, shrink
from benchmarks.peers.dialects import spelling, translate
from benchmarks.peers.environment import prepare
from benchmarks.peers.positions import Judge, Question, answers, ask_monitor, ask_oracle
from benchmarks.peers.ways import WAYS, Way

from rvmon.errors import RvmonError
from rvmon.session import Spec
from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Compare,
    CompareOp,
    Formula,
    Interval,
    Literal,
    SignalValue,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement, Signal, Type
from rvmon.spec.print import format_formula
from rvmon.trace.sample import Sample, Trace
from rvmon.trace.schema import Kind

JUDGES: dict[str, Judge] = {"oracle": ask_oracle, "monitor": ask_monitor}
Values = list[bool | None] | list[float | None]


@dataclass(frozen=True, slots=True)
class Verdicts:
    """Settings of `peers`.

    Attributes:
        ways: in which they are asked, with commas; empty: all.
        against: `oracle` or `monitor`.
    """

    ways: str = ",".join(CONTESTS)
    against: str = "oracle"


@dataclass(frozen=True, slots=True)
class Robustness:
    """Settings of `peers-robustness`: the ways in which peers are asked, with commas."""

    ways: str = "rtamt-discrete,rtamt-dense,sentil"


def _asked(ways: str, counts: Counter[str]) -> Iterator[tuple[Way, Peer]]:
    """Each way with the process of its peer; those that are missing are counted."""
    environment = prepare()
    for name in ways.split(","):
        way = WAYS[name]
        if way.package in environment.missing:
            counts[f"{name}: left out, {way.package} is missing"] += 1
            continue
        with Peer(environment.python, way.worker) as peer:
            yield way, peer


def judge_verdicts(seed: int, own: Verdicts, numbers: range) -> Found:
    """The peer's verdict wherever it has one and ours is decided by the trace."""
    counts, texts = Counter[str](), list[str]()
    judge = JUDGES[own.against]
    for way, peer in _asked(own.ways, counts):
        contest = CONTESTS[way.name]
        for number in numbers:
            rng = random.Random(f"{seed}/{way.name}/{number}")
            question, _ = random_question(rng, contest)
            if question is None:
                counts[f"{way.name}: not to be said to it"] += 1
                continue
            try:
                theirs = ask_peer(contest, peer, question)
                ours = answers(question, judge)
            except (PeerError, RvmonError) as error:
                counts[f"{way.name}: no answer, {str(error)[:60]}"] += 1
                continue
            counts[f"{way.name}: pairs"] += 1
            for value, other in zip(ours, theirs, strict=True):
                counts[f"{way.name}: ticks, {_word(value)} / {_word(other)}"] += 1
            if _disagree(ours, theirs):
                small = shrink(question, partial(_differs, contest, peer, judge))
                values = answers(small, judge), ask_peer(contest, peer, small)
                texts.append(f"{way.name}, number {number}\n{_show(contest, small, *values)}")
    return counts, texts


def _differs(contest: Contest, peer: Peer, judge: Judge, question: Question) -> bool:
    try:
        return _disagree(answers(question, judge), ask_peer(contest, peer, question))
    except (PeerError, RvmonError, ValueError):
        return False


def _disagree(ours: Values, theirs: Values) -> bool:
    pairs = zip(ours, theirs, strict=True)
    return any(None not in pair and pair[0] != pair[1] for pair in pairs)


def _word(value: bool | None) -> str:
    return {True: "true", False: "false", None: "open"}[value]


def _show(contest: Contest, question: Question, ours: Values, theirs: Values) -> str:
    asked = translate(question.formula, contest.way.dialect)
    lines = [f"{format_formula(question.formula)}   as   {asked}"]
    for name, column in {**question.columns, "ours": ours, "theirs": theirs}.items():
        cells = ["." if value is None else f"{value:g}" for value in column]
        lines.append(f"  {name:6} " + " ".join(cells))
    return "\n".join(lines)


NAMES = ("x", "y")
TICKS = 24
ORDERS = (CompareOp.LT, CompareOp.LE, CompareOp.GE, CompareOp.GT)
UNARY = (UnaryOp.EVENTUALLY, UnaryOp.ALWAYS, UnaryOp.ONCE, UnaryOp.HISTORICALLY)


def judge_margins(seed: int, own: Robustness, numbers: range) -> Found:
    """Robustness, number for number, wherever ours is one: no window reaches beyond the end."""
    counts, texts = Counter[str](), list[str]()
    for way, peer in _asked(own.ways, counts):
        for number in numbers:
            rng = random.Random(f"{seed}/{way.name}/{number}")
            formula = random_formula(rng, rng.randint(1, 3))
            columns = {name: [float(rng.randint(-4, 4))] for name in NAMES}
            for column in columns.values():
                while len(column) < TICKS:
                    same = rng.random() < 0.5
                    column.append(column[-1] if same else float(rng.randint(-4, 4)))
            try:
                text = translate(formula, way.dialect)
                named = {spelling(name): column for name, column in columns.items()}
                used = {name: column for name, column in named.items() if name in text}
                theirs = peer.ask("judge", formula=text, kind=way.kind, columns=used)["values"]
            except (ValueError, PeerError):
                counts[f"{way.name}: not to be said to it"] += 1
                continue
            ours = _robustness(formula, columns, way)
            counts[f"{way.name}: pairs"] += 1
            counts[f"{way.name}: figures"] += sum(value is not None for value in ours)
            if _disagree(ours, theirs):
                shown = f"{format_formula(formula)}   as   {text}"
                texts.append(f"{way.name}, number {number}: {shown}\n{columns}\n{ours}\n{theirs}")
    return counts, texts


def random_formula(rng: random.Random, depth: int) -> Formula:
    """A formula over comparisons of numbers, with bounded operators that all peers have."""
    if depth == 0:
        bound = Literal(rng.randint(-3, 3))
        return Compare(rng.choice(ORDERS), SignalValue(rng.choice(NAMES)), bound)
    kind, low = rng.random(), rng.choice((0, 0, rng.randint(1, 3)))
    window, operand = Interval(low, low + rng.randint(1, 4)), random_formula(rng, depth - 1)
    if kind < 0.15:
        return Unary(UnaryOp.NOT, operand)
    if kind < 0.6:
        return Unary(rng.choice(UNARY), operand, window)
    left = random_formula(rng, rng.randint(0, depth - 1))
    if kind < 0.8:
        return Binary(rng.choice((BinaryOp.AND, BinaryOp.OR)), left, operand)
    return Binary(rng.choice((BinaryOp.UNTIL, BinaryOp.SINCE)), left, operand, window)


def _robustness(formula: Formula, columns: dict[str, list[float]], way: Way) -> Values:
    """Ours at every tick; `None` where it depends on what comes after the trace, or is infinite."""
    requirement = Requirement("R", Mode.UPON, BoundAtom(Bound.START), formula)
    signals = {name: Signal(name, Type(Kind.REAL)) for name in columns}
    spec = CheckedSpec("robustness", "", way.time, signals, {}, {"R": requirement})
    samples = [Sample(t, {n: column[t] for n, column in columns.items()}) for t in range(TICKS)]
    stream = Spec(spec).robustness(Trace(tuple(samples), frozenset(columns))).streams["R"]
    found = (one.low if one.low == one.high else None for _, one in stream)
    return [None if value is None or abs(value) == float("inf") else value for value in found]


COMPARISONS = {
    "peers": Comparison(
        "reelay, rtamt, mstlo and SENTIL: verdicts at every tick (made from the package index)",
        judge_verdicts,
        "formulas for each way to ask",
        (Verdicts(),),
        250,
    ),
    "peers-robustness": Comparison(
        "rtamt and SENTIL: robustness at every tick",
        judge_margins,
        "formulas for each way to ask",
        (Robustness(),),
        250,
    ),
}
