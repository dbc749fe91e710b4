"""What each kind of requirement that people write costs per sample.

    python -m benchmarks.kinds [--rows 4000] [--time sampled] [--events 5] [--unknown 0] [WORD …]

Thirteen kinds, each demanded at every instant and upon an event that comes in 5 % of the samples,
or in `--events` of them, over values that are drawn anew and cross at every row, a second apart,
and of which `--unknown` per cent are NaN. Then one for each of 1,000 keys that are all waiting, of
which each sample concerns one. Processor time of `step`, all in, the least of three passes. With
words, only kinds that have one of them.
"""

from __future__ import annotations

import argparse
import math
import random
import statistics
import sys
import time
from collections.abc import Iterator, Sequence

from rvmon import loads
from rvmon.session import Spec
from rvmon.trace.sample import Value

SECOND = 10**9

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


KEYED = """event ask(id : int)
event done(id : int)
requirement R
  upon ask then within 5000 s done.id == i
  for each i in ask.id
"""


def requirements() -> Iterator[tuple[str, str]]:
    """Name and text of each."""
    for name, formula in KINDS.items():
        yield f"{name}, always", f"always ({formula})"
        yield f"{name}, upon", f"upon e then ({formula})"


def rows_of(count: int, events: float, unknown: float) -> list[dict[str, Value]]:
    """Samples in which all values change, and in so many per cent of them an event occurs."""
    rng = random.Random("kinds")
    rows: list[dict[str, Value]] = []
    for _ in range(count):
        row: dict[str, Value] = {
            name: math.nan if rng.random() * 100 < unknown else rng.uniform(0, 10) for name in "xy"
        }
        if rng.random() * 100 < events:
            row["e"] = True
        rows.append(row)
    return rows


def keyed_rows(count: int, keys: int = 1000) -> list[dict[str, Value]]:
    """So many are asked; then one after the other is answered, and asked again at once."""
    rng = random.Random("keys")
    rows: list[dict[str, Value]] = [{"ask": {"id": key}} for key in range(keys)]
    for _ in range(count):
        payload = {"id": rng.randrange(keys)}
        rows += [{"done": payload}, {"ask": payload}]
    return rows


def measured(
    spec: Spec,
    rows: Sequence[dict[str, Value]],
    seconds: float,
    only: Sequence[str] | None = None,
) -> float:
    """Nanoseconds per sample."""
    best = float("inf")
    for _ in range(3):
        monitor = spec.monitor(only=only)
        step = monitor.step_ns
        began = time.process_time_ns()
        for place, row in enumerate(rows):
            step(place * SECOND, row)
        spent = time.process_time_ns() - began
        best = min(best, spent / len(rows))
        if spent > seconds * 1e9:
            break
    return best


def main(argv: Sequence[str]) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Kinds of requirements.")
    parser.add_argument("--rows", type=int, default=4000)
    parser.add_argument("--time", choices=("held", "sampled"), default="held")
    parser.add_argument("--seconds", type=float, default=1.0, help="for more than one pass")
    parser.add_argument("--events", type=float, default=5, help="per cent of the samples with one")
    parser.add_argument("--unknown", type=float, default=0, help="per cent of the values")
    parser.add_argument("words", nargs="*")
    options = parser.parse_args(argv)
    rows = rows_of(options.rows, options.events, options.unknown)
    print("| kind | ns a sample |\n|---|---|")
    figures: list[float] = []
    for name, text in requirements():
        if options.words and not any(word in name for word in options.words):
            continue
        spec = loads(f"time {options.time}\nsignal x, y : real\nevent e\nrequirement R\n  {text}\n")
        figures.append(measured(spec, rows, options.seconds))
        print(f"| {name} | {figures[-1]:,.0f} |", flush=True)
    if not options.words:
        spec = loads(f"time {options.time}\n{KEYED}")
        each = measured(spec, keyed_rows(options.rows), options.seconds)
        print(f"| each of 1,000 keys | {each:,.0f} |")
    print(f"{len(figures)} kinds, median {statistics.median(figures):,.0f} ns")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
