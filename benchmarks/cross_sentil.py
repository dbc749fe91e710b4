"""Our robustness against SENTIL's on random formulas over numbers, at every sample.

    python -m benchmarks.cross_sentil --pairs 10000

It runs where the package `sentil` is installed beside rvmon (0.3.1 was compared). The same are
comparisons, `not`, `and`, `or`, `eventually`, `always`, `once`, `historically`, `until` and `since`
over samples (`time sampled`), with bounds in the stamps' unit. Compared wherever ours is one
number: SENTIL leaves out what lies behind the end, where ours is an interval. Its dense time draws
lines between samples, ours holds values: that is not compared. A trace is judged by twenty
formulas, by each way that measures. Prints how much was compared and every disagreement; exits 1 if
there is one.
"""

from __future__ import annotations

import argparse
import importlib
import random
import sys
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from benchmarks.cross_robustness import NAMES, Tally, random_formula

from rvmon.session import Spec
from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Compare,
    Formula,
    Literal,
    SignalValue,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement, Signal, TimeModel, Type
from rvmon.spec.print.printer import format_formula
from rvmon.trace.schema import Kind

ROWS = 24
TOGETHER = 20
WAYS = ("samples", "columns")
_UNARY = {
    UnaryOp.EVENTUALLY: "eventually",
    UnaryOp.ALWAYS: "always",
    UnaryOp.ONCE: "once",
    UnaryOp.HISTORICALLY: "historically",
}
_BINARY = {
    BinaryOp.AND: "and",
    BinaryOp.OR: "or",
    BinaryOp.UNTIL: "until",
    BinaryOp.SINCE: "since",
}


def said(formula: Formula) -> str:
    """A formula as SENTIL reads it."""
    match formula:
        case Compare(op=op, left=SignalValue(name=name), right=Literal(value=value)):
            return f"({name} {op.value} {value})"
        case Unary(op=UnaryOp.NOT, operand=operand):
            return f"(not {said(operand)})"
        case Unary(op=op, operand=operand, interval=window) if window is not None:
            return f"({_UNARY[op]}[{window.low},{window.high}] {said(operand)})"
        case Binary(op=op, left=left, right=right, interval=window):
            bounds = "" if window is None else f"[{window.low},{window.high}]"
            return f"({said(left)} {_BINARY[op]}{bounds} {said(right)})"
        case _:
            raise AssertionError("it is not generated")


def spec_of(formulas: Sequence[Formula]) -> Spec:
    """Each formula as it is owed from the first sample on."""
    owed = {
        f"R{n}": Requirement(f"R{n}", Mode.UPON, BoundAtom(Bound.START), formula)
        for n, formula in enumerate(formulas)
    }
    return Spec(
        CheckedSpec(
            name="robustness",
            title="",
            time=TimeModel.SAMPLED,
            signals={name: Signal(name, Type(Kind.REAL)) for name in NAMES},
            events={},
            requirements=owed,
        )
    )


def ours(
    spec: Spec, times: list[int], columns: dict[str, list[float]], way: str
) -> dict[str, list[float | None]]:
    """Our robustness at every sample; `None` where it depends on what comes after the trace."""
    trace: Any = {name: np.array(own) for name, own in {"t_ns": times, **columns}.items()}
    if way == "samples":
        rows = [{name: column[row] for name, column in columns.items()} for row in range(ROWS)]
        trace = zip((t * 1e-9 for t in times), rows, strict=True)
    streams = spec.robustness(trace).streams
    return {
        name: [found.low if found.low == found.high else None for _, found in stream]
        for name, stream in streams.items()
    }


def compare(sentil: Any, rng: random.Random, ways: Sequence[str], tally: Tally) -> None:
    """Some formulas on one trace, by some of the ways."""
    formulas = [random_formula(rng, rng.randint(1, 3)) for _ in range(TOGETHER)]
    times, t = [], 0
    for _ in range(ROWS):
        times.append(t)
        t += rng.choice((1, 1, 1, 2, 4))
    columns = {name: [float(rng.randint(-4, 4)) for _ in times] for name in NAMES}
    trace = sentil.Trace([float(t) for t in times], columns)
    spec = spec_of(formulas)
    found = {way: ours(spec, times, columns, way) for way in ways}
    for number, formula in enumerate(formulas):
        text = said(formula)
        theirs = sentil.Formula.parse(text).robustness_signal(trace).tolist()
        tally.pairs += 1
        for way in ways:
            wrong = []
            for t, value, other in zip(times, found[way][f"R{number}"], theirs, strict=True):
                tally.open += value is None
                tally.figures += value is not None
                if value not in (None, other):
                    wrong.append(f"at {t}: {value:g}, theirs {other:g}")
            if wrong:
                shown = f"{way}: {format_formula(formula)}   as   {text}"
                tally.disagreements.append(f"{shown}\n{times}\n{columns}\n{wrong}")


def main(argv: list[str]) -> int:
    """Run the campaign and print its figures."""
    parser = argparse.ArgumentParser(description="Our robustness against SENTIL's.")
    parser.add_argument("--pairs", type=int, default=1_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--way", nargs="+", choices=WAYS, default=[*WAYS])
    parser.add_argument("--show", type=int, default=3, help="disagreements printed at most")
    options = parser.parse_args(argv)
    try:
        sentil = importlib.import_module("sentil")
    except ImportError as error:
        print(f"sentil is missing: {error}")
        return 0
    tally, began = Tally(), time.perf_counter()
    for number in range(options.pairs // TOGETHER):
        compare(sentil, random.Random(f"{options.seed}/sentil/{number}"), options.way, tally)
    took = time.perf_counter() - began
    print(f"sentil against {', '.join(options.way)}, seed {options.seed}, {took:.0f} s")
    print(f"  pairs {tally.pairs}, figures compared {tally.figures}, open {tally.open}")
    print(f"  disagreements {len(tally.disagreements)}")
    for text in tally.disagreements[: options.show]:
        print("\n" + text)
    return 1 if tally.disagreements else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
