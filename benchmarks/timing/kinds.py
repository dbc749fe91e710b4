"""What a sample costs, by requirement: kinds that people write, published ones, nested windows.

Kinds are demanded at every instant and upon an event that comes in 5 % of the samples, over values
that are drawn anew and cross at every row, a second apart, of which `--unknown` per cent are NaN;
then one for each of 1,000 keys that are all waiting. Published requirements stand in
`benchmarks/published`, each with its source; numbers are drawn near those that they compare with.
Windows within windows have 10 to 1,000 samples in the longer one; those of counts, durations and
extremes up to 100,000. Processor time of `step`, all
in, the least of three passes. With words, only lines that have one of them.
"""

from __future__ import annotations

import argparse
import math
import random
import re
import statistics
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from rvmon import load, loads
from rvmon.session import Spec
from rvmon.trace.sample import Value
from rvmon.trace.schema import Kind

SECOND = 10**9
PASSES = 3
PUBLISHED = Path(__file__).parents[1] / "published"
_COMPARED = re.compile(r"[<>=]=? (\d+(?:\.\d+)?)(?! m?s)")

Row = dict[str, Value]
Rows = Sequence[Row]

KINDS = {
    "respond": "x > 5 -> within 100 s x < 5",
    "respond, then hold": "x > 8 -> within 50 s for 30 s x < 6",
    "hold from now": "x > 9.9 -> for 20 s y < 9.9",
    "hold after a while": "x > 9.9 -> G[5 s, 20 s] y < 9.9",
    "delayed window": "x > 8 -> F[2 s, 5 s] y > 5",
    "soon": "within 10 s x > 5",
    "recur": "for 100 s within 10 s x > 5",
    "stabilise": "within 30 s for 20 s y <= 9.9",
    "until": "(y < 9.9) U[0 s, 20 s] x > 9",
    "either": "(x < 4) or for 10 s y < 9",
    "chain": "x > 9 -> within 10 s (y > 5 and within 10 s x < 5)",
    "not before": "(y < 8) W x > 5",
    "past": "x > 9 -> once[0 s, 50 s] y > 9",
}

NESTED = {
    "F G": "upon x > 8 then F[0 s, {long} s] G[0 s, {short} s] x < 6",
    "G F": "upon start then G[0 s, {long} s] F[0 s, {short} s] x > 5",
    "stop": "upon e then F[0 s, {short} s] G[0 s, {long} s] x <= 9.9",
    "recurrence": "always (x > 8 -> F[0 s, {long} s] G[0 s, {short} s] x < 6)",
    "delayed": "whenever x > 8 then F[{short} s, {long} s] y > 5",
    "either": "upon x > 8 then F[0 s, {long} s] (x < 4 | G[0 s, {short} s] y < 6)",
    "until": "upon x > 8 then (F[0 s, {short} s] x < 6) U[0 s, {long} s] G[0 s, {short} s] y < 6",
}
"""Over windows of two lengths, the shorter a fifth of the longer."""

AMOUNTS = {
    "count": "upon count(e, {d} s) >= 1000000000 then e",
    "duration": "upon duration(a, {d} s) >= {d} s then e",
    "share": "upon share(a, {d} s) >= 100 % then e",
    "max": "upon max(x, {d} s) <= 0 then e",
    "sum": "upon sum(x, {d} s) < 0 then e",
    "mean": "upon mean(x, {d} s) > 3.5 then e",
    "integral": "upon integral(x, {d} s) < 0 s then e",
    "mean, moving": "upon mean(x, {d} s) > x then e",
    "integral()": "upon integral(x) < 0 s then e",
    "delta": "upon delta(x, {d} s) > 100 then e",
    "distinct": "upon distinct(x, {d} s) > 1000000000 then e",
    "count(last)": "upon count(last({d}, a)) >= 1000000000 then e",
    "sum(last)": "upon sum(last({d}, x)) < 0 then e",
    "variance(last)": "upon variance(last({d}, x)) > 100 then e",
    "sum since trigger": "upon start then for 1000000 s sum(x since trigger) >= 0",
}
"""Over a window of so many samples."""

WINDOWS = (10, 100, 1000)

KEYED = """event ask(id : int)
event done(id : int)
requirement R
  upon ask then within 5000 s done.id == i
  for each i in ask.id
"""


def rows_of(count: int, unknown: float) -> Rows:
    """Samples in which all values change, and now and then an event occurs."""
    rng = random.Random("kinds")
    rows: list[Row] = []
    for _ in range(count):
        row: Row = {
            name: math.nan if rng.random() * 100 < unknown else rng.uniform(0, 10) for name in "xy"
        }
        if rng.random() < 0.05:
            row["e"] = True
        rows.append(row)
    return rows


def keyed_rows(count: int, keys: int = 1000) -> Rows:
    """So many are asked; then one after the other is answered, and asked again at once."""
    rng = random.Random("keys")
    rows: list[Row] = [{"ask": {"id": key}} for key in range(keys)]
    for _ in range(count):
        payload = {"id": rng.randrange(keys)}
        rows += [{"done": payload}, {"ask": payload}]
    return rows


def published_rows(spec: Spec, text: str, count: int) -> Rows:
    """Samples whose numbers lie on both sides of those that a text compares with."""
    rng = random.Random("published")
    near = [float(number) for number in _COMPARED.findall(text)] or [1.0]
    rows: list[Row] = []
    for _ in range(count):
        row: Row = {}
        for name, signal in spec.checked.signals.items():
            if signal.type.kind is not Kind.BOOL:
                row[name] = rng.choice(near) + rng.choice((-1, 0, 1)) * rng.random()
            elif not rows or rng.random() < 1 / 3:
                row[name] = rng.random() < 0.5
        rows.append(row)
    return rows


def measured(spec: Spec, rows: Rows, only: Sequence[str] | None = None, filled: int = 0) -> float:
    """Nanoseconds per sample, behind so many that fill a window."""
    best = float("inf")
    for _ in range(PASSES):
        step = spec.monitor(only=only).step_ns
        for place, row in enumerate(rows[:filled]):
            step(place * SECOND, row)
        began = time.process_time_ns()
        for place, row in enumerate(rows[filled:], filled):
            step(place * SECOND, row)
        spent = time.process_time_ns() - began
        best = min(best, spent / (len(rows) - filled))
        if spent > SECOND:
            break
    return best


def lines(
    count: int, model: str, unknown: float
) -> Iterator[tuple[str, Spec, Rows, str | None, int]]:
    """Name, specification, samples, the requirement that is meant, and how many fill a window."""
    rows = rows_of(count, unknown)
    head = f"time {model}\nsignal x, y : real\nevent e\nrequirement R\n  "
    for name, formula in KINDS.items():
        for when, text in (("always", f"always ({formula})"), ("upon", f"upon e then ({formula})")):
            yield f"{name}, {when}", loads(f"{head}{text}\n"), rows, None, 0
    yield "each of 1,000 keys", loads(f"time {model}\n{KEYED}"), keyed_rows(count), None, 0
    for name, form in NESTED.items():
        for window in WINDOWS:
            text = form.format(long=window, short=window // 5)
            yield f"nested: {name}, {window} samples", loads(f"{head}{text}\n"), rows, None, 0
    amounts = head.replace("event e\n", "event e\nsignal a : bool\n")
    for name, form in AMOUNTS.items():
        for window in (10, 1_000, 100_000):
            changing: list[Row] = [
                {"a": n % 2 == 0, "x": float(n % 7), "e": n % 3 == 0} for n in range(window + count)
            ]
            spec = loads(f"{amounts}{form.format(d=window)}\n")
            yield f"amount: {name} of {window:,} samples", spec, changing, None, window
    for file in sorted(PUBLISHED.glob("*.rv")):
        spec = load(file)
        own = published_rows(spec, file.read_text(), count // 2)
        for name in spec.requirements:
            yield f"published: {file.stem} {name}", spec, own, name, 0


def add_options(parser: argparse.ArgumentParser) -> None:
    """What may be asked of the kinds."""
    parser.add_argument("--rows", type=int, default=4000, help="of kinds")
    parser.add_argument("--time", choices=("held", "sampled"), default="held", help="of kinds")
    parser.add_argument("--unknown", type=float, default=0, help="per cent of the values of kinds")


def measure(options: argparse.Namespace) -> int:
    print("| requirement | ns a sample |\n|---|---|")
    figures: list[float] = []
    for name, spec, rows, only, filled in lines(options.rows, options.time, options.unknown):
        if not options.kinds or any(word in name for word in options.kinds):
            figures.append(measured(spec, rows, [only] if only else None, filled))
            print(f"| {name} | {figures[-1]:,.0f} |", flush=True)
    print(f"{len(figures)} lines, median {statistics.median(figures):,.0f} ns", end="")
    print(f", most {max(figures):,.0f} ns")
    return 0
