"""The ratio of the cost of a sample in a hard stream to that in a comparable easy one."""

from __future__ import annotations

import gc
import math
import random
import statistics
import time
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.program import table
from benchmarks.timing.workload import SECOND

from rvmon import loads
from rvmon.trace.sample import Value

MILLISECOND = 10**6
FORMS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
HEAD = "signal x, y : real\nsignal a : bool\nevent e\nrequirement R\n  "
KEYED = """event put(id : int), got(id : int)
requirement R
  upon put and put.id == k then within 1000 s (got and got.id == k)
  for each k in put.id
"""

Row = dict[str, Value]


@dataclass(frozen=True, slots=True)
class Stream:
    """A specification and samples."""

    text: str
    rows: Sequence[Row]
    period: int  # ticks from one to the next

    def cost(self, count: int) -> float:
        """CPU nanoseconds per sample and its records, over the last `count` samples."""
        step, period = loads(self.text).monitor(keep=100).step_ns, self.period
        before = len(self.rows) - count
        for place, row in enumerate(self.rows[:before]):
            step(place * period, row)
        measured = self.rows[before:]
        gc.freeze()  # collections then visit only what the stream allocates
        began = time.process_time_ns()
        for place, row in enumerate(measured, before):
            step(place * period, row)
        spent = time.process_time_ns() - began
        gc.unfreeze()
        return spent / len(measured)


def drawn(count: int, unknown: float = 0, events: float = 0) -> list[Row]:
    """Samples with new values, with shares of NaN and of samples with the event."""
    rng = random.Random("drawn")
    rows: list[Row] = []
    for _ in range(count):
        row: Row = {name: rng.uniform(0, 10) for name in "xy"}
        if rng.random() < unknown:
            row["xy"[rng.random() < 0.5]] = math.nan
        if rng.random() < events:
            row["e"] = True
        rows.append(row)
    return rows


def _keys(count: int, live: int) -> Sequence[Row]:
    first: list[Row] = [{"put": {"id": key}} for key in range(live)]
    return first + [{"put": {"id": n + live}, "got": {"id": n}} for n in range(count)]


def _open(count: int, attempts: int) -> Sequence[Row]:
    first: list[Row] = [{"x": 0.0, "y": 0.0, "e": True} for _ in range(attempts)]
    return [*first, *drawn(count)]


def _pulses(count: int, high: float) -> list[Row]:
    """Triggers; x pulses and pauses alternately, y is high for 3 of 1,900 samples."""
    return [
        {"x": high * (n // 3000 % 2 == 0 and n % 2), "y": 10.0 * (n % 1900 < 3), "e": True}
        for n in range(count)
    ]


def _counted(count: int) -> list[Row]:
    """Samples with a regular pattern, for sums and counts."""
    return [{"a": n % 2 == 0, "x": float(n % 7), "e": n % 3 == 0} for n in range(count)]


def cells(count: int) -> Iterator[tuple[str, Stream, str, Stream, float]]:
    """Name and stream of the hard and of the easy case, and the highest allowed ratio."""
    every, plain, some = (drawn(count, events=share) for share in (1, 0, 0.05))
    nan, rare = drawn(count, unknown=0.01), drawn(count, events=0.02)
    pulses, still = _pulses(count, 10), _pulses(count, 0)
    counted, short = _counted(100_000 + count), _counted(10 + count)
    kinds = (
        ("failing", "{} that fails at 30 % of the rows", "it holds", plain, plain, SECOND),
        ("unknown", "{}, 1 % NaN", "no NaN", nan, plain, SECOND),
        ("triggered", "{} at 1 kHz, each sample a trigger", "2 % are", every, rare, MILLISECOND),
        ("later", "{}, each sample a trigger", "it opens at once", every, every, MILLISECOND),
        ("pulses", "{}, triggers, pulses that pause", "no pulses", pulses, still, MILLISECOND),
        ("nested", "nested: {}, 1,000 samples", "10 samples", some, some, SECOND),
        ("amounts", "{} of 100,000 samples", "10 samples", counted, short, SECOND),
    )
    for kind, hard, near, *samples, period in kinds:
        for name, form in FORMS[kind].items():
            texts = form if isinstance(form, list) else [form] * 2
            lengths = (100_000 if kind == "amounts" else 1_000, 10)
            one, other = (
                Stream(HEAD + text.format(long=n, short=n // 5), rows, period)
                for text, n, rows in zip(texts, lengths, samples, strict=True)
            )
            yield hard.format(name), one, near, other, 3
    one, other = (Stream(KEYED, _keys(count, n), MILLISECOND) for n in (1_000, 10))
    yield "1,000 keys", one, "10 keys", other, 3
    many, text = min(5 * count, 100_000), f"{HEAD}upon e then within 3600 s x > 11\n"
    one, other = (Stream(text, _open(count, n), MILLISECOND) for n in (many, 1))
    yield f"{many:,} attempts open", one, "one open", other, 1.2


def lines(count: int, repeats: int) -> Iterator[str]:
    """The table, with medians of alternating passes."""
    head = ("stream", "CPU per sample", "neighbour", "CPU per sample", "ratio", "wanted", "met")
    return table(head, _rows(count, repeats))


def _rows(count: int, repeats: int) -> Iterator[Sequence[str]]:
    for name, hard, near, quiet, most in cells(count):
        both = [(hard.cost(count), quiet.cost(count)) for _ in range(repeats)]
        own, its = (statistics.median(column) for column in zip(*both, strict=True))
        ratio = statistics.median(one / other for one, other in both)
        met = "yes" if ratio <= most else "no"
        figures = f"{ratio:.1f}×", f"≤ {most:g}×", met
        yield name, f"{own:,.0f} ns", near, f"{its:,.0f} ns", *figures
