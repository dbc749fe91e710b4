"""A hard stream beside its quiet neighbour: how many times as much does a sample cost?"""

from __future__ import annotations

import gc
import math
import random
import statistics
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from benchmarks.output import table

from rvmon import loads
from rvmon.trace.sample import Value

Row = dict[str, Value]
Rows = Sequence[Row]
SECOND, MILLISECOND = 10**9, 10**6
HEAD = "signal x, y : real\nevent e\nrequirement R\n  "
KEYED = """event put(id : int), got(id : int)
requirement R
  upon put and put.id == k then within 1000 s (got and got.id == k)
  for each k in put.id
"""
OPEN = f"{HEAD}upon e then within 3600 s x > 11\n"


@dataclass(frozen=True, slots=True)
class Stream:
    """A specification and samples."""

    text: str  # the specification
    rows: Rows  # the samples
    period: int = SECOND  # ticks from one to the next
    before: int = 0  # samples that are not measured


def values(count: int, unknown: float = 0, events: float = 0) -> Rows:
    """Samples of which all values are new; shares of NaN and of samples with the event."""
    rng = random.Random("cliffs")
    rows: list[Row] = []
    for _ in range(count):
        row: Row = {name: rng.uniform(0, 10) for name in "xy"}
        if rng.random() < unknown:
            row["xy"[rng.random() < 0.5]] = math.nan
        if rng.random() < events:
            row["e"] = True
        rows.append(row)
    return rows


def _keys(count: int, live: int) -> Rows:
    first: list[Row] = [{"put": {"id": key}} for key in range(live)]
    return first + [{"put": {"id": n + live}, "got": {"id": n}} for n in range(count)]


def _open(count: int, attempts: int) -> Rows:
    first: list[Row] = [{"x": 0.0, "y": 0.0, "e": True} for _ in range(attempts)]
    return [*first, *values(count)]


FAILING = {
    "a limit": ("always x < 7", "always x < 11"),
    "a response": ("always (x > 5 -> within 3 s y < 1.2)", "always (x > 5 -> within 3 s y < 9)"),
    "for a while": ("always (x > 5 -> for 3 s y < 8.7)", "always (x > 5 -> for 3 s y < 11)"),
}
UNKNOWN = {
    "a response": "always (x > 8 -> within 50 s y < 6)",
    "a window": "always (x > 9.9 -> for 20 s y < 9.9)",
    "the past": "always (x > 9 -> once[0 s, 50 s] y > 9)",
}
TRIGGERED = {
    "within 10 s": "within 10 s x > 9.995",
    "for 10 s": "for 10 s x < 9.999",
    "until, 10 s": "(y < 9.999) until[0 s, 10 s] x > 9.995",
    "nested, 10 s": "within 10 s for 1 s x < 9.99",
}
LATER = {
    "F[2 s, 10 s]": ("F[2 s, 10 s] x > 9.995", "within 10 s x > 9.995"),
    "G[2 s, 10 s]": ("G[2 s, 10 s] x < 9.999", "for 10 s x < 9.999"),
    "until[2 s, 10 s]": ("(y < 9.999) until[2 s, 10 s] x > 9.995", "within 10 s x > 9.995"),
}


def cells(count: int) -> Iterator[tuple[str, Stream, str, Stream, float]]:
    """What is hard, its quiet neighbour, and the most times that it may cost."""
    plain, every, rare = values(count), values(count, events=1), values(count, events=0.02)
    for name, texts in FAILING.items():
        hard, quiet = (Stream(HEAD + text, plain) for text in texts)
        yield f"{name} that fails at 30 % of the rows", hard, "it holds", quiet, 3
    for name, text in UNKNOWN.items():
        hard, quiet = (Stream(HEAD + text, values(count, share)) for share in (0.01, 0))
        yield f"{name}, 1 % NaN", hard, "no NaN", quiet, 3
    for name, text in TRIGGERED.items():
        hard, quiet = (Stream(f"{HEAD}upon e then {text}", n, MILLISECOND) for n in (every, rare))
        yield f"{name} at 1 kHz, each sample a trigger", hard, "2 % are", quiet, 3
    for name, texts in LATER.items():
        hard, quiet = (Stream(f"{HEAD}upon e then {o}", every, MILLISECOND) for o in texts)
        yield f"{name}, each sample a trigger", hard, "the window opens at once", quiet, 3
    hard, quiet = (Stream(KEYED, _keys(count, n), MILLISECOND, n) for n in (1_000, 10))
    yield "1,000 keys", hard, "10 keys", quiet, 3
    many = min(5 * count, 100_000)
    hard, quiet = (Stream(OPEN, _open(count, n), MILLISECOND, n) for n in (many, 1))
    yield f"{many:,} attempts open", hard, "one open", quiet, 1.2


def cost(stream: Stream) -> float:
    """CPU nanoseconds of a sample, `step` and what it hands out."""
    monitor = loads(stream.text).monitor(keep=100)
    step, period = monitor.step_ns, stream.period
    for place, row in enumerate(stream.rows[: stream.before]):
        step(place * period, row)
    measured = stream.rows[stream.before :]
    gc.freeze()  # what a collection costs is what the stream leaves, not what the process holds
    began = time.process_time_ns()
    for place, row in enumerate(measured, stream.before):
        step(place * period, row)
    spent = time.process_time_ns() - began
    gc.unfreeze()
    return spent / len(measured)


def cliffs(*, rows: int = 20_000, repeats: int = 5) -> None:
    """Hard streams beside their quiet neighbours."""
    for line in lines(rows, repeats):
        print(line, flush=True)


def lines(count: int, repeats: int) -> Iterator[str]:
    """The table: medians of passes in turn."""
    head = ("stream", "CPU per sample", "neighbour", "CPU per sample", "ratio", "wanted", "met")
    return table(head, _rows(count, repeats))


def _rows(count: int, repeats: int) -> Iterator[Sequence[str]]:
    for name, hard, near, quiet, most in cells(count):
        both = [(cost(hard), cost(quiet)) for _ in range(repeats)]
        own, its = (statistics.median(column) for column in zip(*both, strict=True))
        ratio = statistics.median(one / other for one, other in both)
        met = "yes" if ratio <= most else "no"
        figures = f"{ratio:.1f}×", f"≤ {most:g}×", met
        yield name, f"{own:,.0f} ns", near, f"{its:,.0f} ns", *figures
