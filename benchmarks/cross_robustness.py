"""Our robustness against rtamt's on random formulas over numbers, at every tick.

    python -m benchmarks.cross_robustness --pairs 10000

Compared wherever ours is one number: no window of the formula reaches beyond the end of the trace.
Prints how much was compared and every disagreement; exits 1 if there is one.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from dataclasses import dataclass, field

from benchmarks.peers.client import Peer, PeerError
from benchmarks.peers.dialects import spelling, translate
from benchmarks.peers.environment import prepare
from benchmarks.peers.ways import WAYS, Way
from tests.tools.common_fragment import UntranslatableError

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
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement, Signal, TimeModel, Type
from rvmon.spec.print.printer import format_formula
from rvmon.trace.sample import Sample, Trace
from rvmon.trace.schema import Kind

NAMES = ("x", "y")
TICKS = 24
ORDERS = (CompareOp.LT, CompareOp.LE, CompareOp.GE, CompareOp.GT)
UNARY = (UnaryOp.EVENTUALLY, UnaryOp.ALWAYS, UnaryOp.ONCE, UnaryOp.HISTORICALLY)


@dataclass(slots=True)
class Tally:
    """What a campaign found."""

    pairs: int = 0
    figures: int = 0
    open: int = 0
    refused: int = 0
    disagreements: list[str] = field(default_factory=list)


def random_formula(rng: random.Random, depth: int) -> Formula:
    """A formula over comparisons of numbers, with operators that rtamt has."""
    if depth == 0:
        bound = Literal(rng.randint(-3, 3))
        return Compare(rng.choice(ORDERS), SignalValue(rng.choice(NAMES)), bound)
    kind = rng.random()
    if kind < 0.15:
        return Unary(UnaryOp.NOT, random_formula(rng, depth - 1))
    if kind < 0.6:
        operand = random_formula(rng, depth - 1)
        return Unary(rng.choice(UNARY), operand, random_window(rng))
    left, right = random_formula(rng, rng.randint(0, depth - 1)), random_formula(rng, depth - 1)
    if kind < 0.8:
        return Binary(rng.choice((BinaryOp.AND, BinaryOp.OR)), left, right)
    return Binary(rng.choice((BinaryOp.UNTIL, BinaryOp.SINCE)), left, right, random_window(rng))


def random_window(rng: random.Random) -> Interval:
    """A bounded window."""
    low = rng.choice((0, 0, rng.randint(1, 3)))
    return Interval(low, low + rng.randint(1, 4))


def ours(formula: Formula, columns: dict[str, list[float]], model: TimeModel) -> list[float | None]:
    """Our robustness at every tick; `None` where it depends on what comes after the trace."""
    requirement = Requirement("R", Mode.UPON, BoundAtom(Bound.START), formula)
    spec = CheckedSpec(
        name="robustness",
        title="",
        time=model,
        signals={name: Signal(name, Type(Kind.REAL)) for name in columns},
        events={},
        requirements={"R": requirement},
    )
    samples = [Sample(t, {n: column[t] for n, column in columns.items()}) for t in range(TICKS)]
    stream = Spec(spec).robustness(Trace(tuple(samples), frozenset(columns))).streams["R"]
    return [found.low if found.low == found.high else None for _, found in stream]


def compare(way: Way, peer: Peer, rng: random.Random, tally: Tally) -> None:
    """One formula on one trace."""
    formula = random_formula(rng, rng.randint(1, 3))
    columns = {name: [float(rng.randint(-4, 4))] for name in NAMES}
    for column in columns.values():
        while len(column) < TICKS:
            column.append(column[-1] if rng.random() < 0.5 else float(rng.randint(-4, 4)))
    try:
        text = translate(formula, way.dialect)
        named = {spelling(name): column for name, column in columns.items()}
        used = {name: column for name, column in named.items() if name in text}
        theirs = peer.ask("judge", formula=text, kind=way.kind, columns=used)["values"]
    except (UntranslatableError, PeerError):
        tally.refused += 1
        return
    own = ours(formula, columns, way.time)
    tally.pairs += 1
    wrong = []
    for tick, (value, other) in enumerate(zip(own, theirs, strict=True)):
        if value is None or other is None or abs(value) > 1e200:
            tally.open += 1
            continue
        tally.figures += 1
        if value != other:
            wrong.append(f"tick {tick}: {value:g}, theirs {other:g}")
    if wrong:
        tally.disagreements.append(f"{format_formula(formula)}   as   {text}\n{columns}\n{wrong}")


def main(argv: list[str]) -> int:
    """Run the campaigns and print their figures."""
    parser = argparse.ArgumentParser(description="Our robustness against rtamt's.")
    parser.add_argument("--pairs", type=int, default=1_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--show", type=int, default=3, help="disagreements printed at most")
    options = parser.parse_args(argv)
    environment = prepare()
    if "rtamt" in environment.missing:
        print(f"rtamt is missing: {environment.missing['rtamt']}")
        return 0
    failed = False
    for name in ("rtamt-discrete", "rtamt-dense"):
        way, tally = WAYS[name], Tally()
        began = time.perf_counter()
        with Peer(environment.python, way.worker) as peer:
            number = 0
            while tally.pairs < options.pairs:
                rng = random.Random(f"{options.seed}/{name}/{number}")
                compare(way, peer, rng, tally)
                number += 1
        print(f"{name}, seed {options.seed}, {time.perf_counter() - began:.0f} s")
        print(f"  pairs {tally.pairs}, not to be said to it {tally.refused}")
        print(f"  figures compared {tally.figures}, open {tally.open}")
        print(f"  disagreements {len(tally.disagreements)}")
        for text in tally.disagreements[: options.show]:
            print("\n" + text)
        failed = failed or bool(tally.disagreements)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
