"""Verdicts and robustness of other monitors on random formulas, tick by tick."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

from benchmarks.peers.client import Peer, PeerError
from benchmarks.peers.dialects import translate
from benchmarks.peers.environment import prepare
from benchmarks.peers.ways import WAYS, Question, Way, answers, ask_oracle
from tests.tools.build import requirement, spec_over, with_operands
from tests.tools.common_fragment import UntranslatableError
from tests.tools.differential import Campaign

from rvmon.errors import RvmonError
from rvmon.language.checked import formula as rv
from rvmon.language.checked.names_read import names_read
from rvmon.language.print import format_formula
from rvmon.session import Spec
from rvmon.testing.generate import NUMBERS, chance, pick
from rvmon.testing.generate.formula import formula
from rvmon.trace.sample import Sample, Trace
from rvmon.trace.schema import Kind

ORDERS = tuple(map(rv.CompareOp, ("<", "<=", ">=", ">")))
PLAIN = rv.SignalAtom | rv.Constant | rv.BoundAtom
Values = Sequence[float | None]


def judge_verdicts(found: Campaign, seed: int, numbers: range) -> None:
    """Reelay, rtamt, mstlo and SENTIL (from the package index): verdicts at every tick."""
    _judge(found, f"{seed}", [*WAYS], numbers, 50, lambda one: answers(one, ask_oracle), Way.truths)


def judge_robustness(found: Campaign, seed: int, numbers: range) -> None:
    """Rtamt and SENTIL: robustness at every tick."""
    ways = ("rtamt-discrete", "rtamt-dense", "sentil")
    _judge(found, f"robustness {seed}", ways, numbers, 100, _robustness, Way.says)


def _judge(
    found: Campaign,
    seed: str,
    ways: Sequence[str],
    numbers: range,
    compared: int,
    own: Callable[[Question], Values],
    its: Callable[[Way, Peer, Question], Values],
) -> None:
    """Compare both on random questions, with `compared` % of comparisons among propositions."""
    environment = prepare()
    for name in ways:
        way = WAYS[name]
        if way.package in environment.missing:
            found.counts[f"{name}: left out, {way.package} is missing"] += 1
            continue
        with Peer(environment.python, way.adapter) as peer:
            for number in numbers:
                question = random_question(random.Random(f"{seed}/{name}/{number}"), way, compared)
                try:
                    ours, theirs = own(question), its(way, peer, question)
                except UntranslatableError:
                    found.counts[f"{name}: not to be said to it"] += 1
                    continue
                except (PeerError, RvmonError) as error:
                    found.counts[f"{name}: no answer, {str(error)[:60]}"] += 1
                    continue
                found.counts[f"{name}: pairs"] += 1
                pairs = [*zip(ours, theirs, strict=True)]
                for pair in pairs:
                    found.counts[f"{name}: ticks, {' / '.join(map(_word, pair))}"] += 1
                if any(None not in pair and pair[0] != pair[1] for pair in pairs):
                    text = _show(way, question, ours, theirs)
                    found.disagreements.append(f"{name}, number {number}\n{text}")


def random_question(rng: random.Random, way: Way, compared: int) -> Question:
    """A random formula, and a random trace whose values stay the same for a while."""
    asked = _with_numbers(rng, formula(rng, way.shape, rng.randint(1, 3)), compared)
    ticks = rng.randint(2, 24)
    columns: dict[str, list[bool | float]] = {}
    for name in sorted({*names_read(asked)} or {"p"}):
        column = columns[name] = []
        while len(column) < ticks:
            if column and chance(rng, 60):
                column.append(column[-1])
            else:
                column.append(float(rng.randint(-2, 3)) if name in NUMBERS else chance(rng, 50))
    return Question(asked, columns, way.time)


def _with_numbers(rng: random.Random, asked: rv.Formula, compared: int) -> rv.Formula:
    """Replace some propositions by comparisons with bounds that no value equals."""
    if isinstance(asked, PLAIN) and chance(rng, compared):
        bound = rv.Literal(rng.randint(-1, 2) + 0.5)
        return rv.Compare(pick(rng, ORDERS), rv.SignalValue(pick(rng, NUMBERS)), bound)
    return with_operands(asked, lambda operand: _with_numbers(rng, operand, compared))


def _robustness(question: Question) -> Values:
    """Our robustness at every tick; `None` if infinite, or open at the end of the trace."""
    kinds = dict.fromkeys(question.columns, Kind.REAL)
    spec = spec_over(kinds, requirement(question.formula), question.time)
    rows = enumerate(zip(*question.columns.values(), strict=True))
    samples = [Sample(t, dict(zip(question.columns, row, strict=True))) for t, row in rows]
    trace = Trace(tuple(samples), frozenset(question.columns))
    stream = Spec(spec).robustness(trace).streams["R"]
    found = [one.low if one.low == one.high else None for _, one in stream]
    return [None if value is None or abs(value) == float("inf") else value for value in found]


def _word(value: float | None) -> str:
    return "open" if value is None else str(value).lower() if value in (True, False) else "a number"


def _show(way: Way, question: Question, ours: Values, theirs: Values) -> str:
    asked = translate(question.formula, way.dialect)
    lines = [f"{format_formula(question.formula)}   as   {asked}"]
    for name, column in {**question.columns, "ours": ours, "theirs": theirs}.items():
        cells = ["." if value is None else f"{value:g}" for value in column]
        lines.append(f"  {name:6} " + " ".join(cells))
    return "\n".join(lines)
