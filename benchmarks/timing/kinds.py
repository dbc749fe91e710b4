"""What a sample costs, by requirement: kinds that people write, published ones, nested windows.

Kinds are demanded at every instant and upon an event that comes in 5 % of the samples, over values
that are drawn anew and cross at every row, a second apart; then one for each of 1,000 keys that are
all waiting. Published requirements stand in `benchmarks/published`, each with its source; numbers
are drawn near those that they compare with.
Windows within windows have 10 to 1,000 samples in the longer one; those of counts, durations and
extremes up to 100,000. Processor time of `step`, all in, the least of three passes. With words,
only lines that have one of them.
"""

from __future__ import annotations

import math
import random
import re
import statistics
import time
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.output import show
from benchmarks.timing.workload import SECOND

from rvmon import load, loads
from rvmon.session import Spec
from rvmon.trace.sample import Value
from rvmon.trace.schema import Kind

PASSES = 3
PUBLISHED = Path(__file__).parents[1] / "published"
FORMS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
_COMPARED = re.compile(r"[<>=]=? (\d+(?:\.\d+)?)(?! m?s)")

Row = dict[str, Value]
Line = tuple[str, Spec, Sequence[Row], str | None, int]
"""Name, specification, samples, the requirement that is meant, and how many fill a window."""

KEYED = """event ask(id : int)
event done(id : int)
requirement R
  upon ask then within 5000 s done.id == i
  for each i in ask.id
"""


def _rows(count: int) -> Iterator[Row]:
    """Samples in which all values change, and now and then an event occurs."""
    rng = random.Random("kinds")
    for _ in range(count):
        row: Row = {name: rng.uniform(0, 10) for name in "xy"}
        yield {**row, "e": True} if rng.random() < 0.05 else row


def _keyed(count: int, keys: int = 1000) -> Iterator[Row]:
    """So many are asked; then one after the other is answered, and asked again at once."""
    rng = random.Random("keys")
    for key in range(keys):
        yield {"ask": {"id": key}}
    for _ in range(count):
        key = rng.randrange(keys)
        for name in ("done", "ask"):
            yield {name: {"id": key}}


def _published(spec: Spec, text: str, count: int) -> Iterator[Row]:
    """Samples whose numbers lie on both sides of those that a text compares with."""
    rng = random.Random("published")
    near = [float(number) for number in _COMPARED.findall(text)] or [1.0]
    for place in range(count):
        row: Row = {}
        for name, signal in spec.checked.signals.items():
            if signal.type.kind is not Kind.BOOL:
                row[name] = rng.choice(near) + rng.choice((-1, 0, 1)) * rng.random()
            elif not place or rng.random() < 1 / 3:
                row[name] = rng.random() < 0.5
        yield row


def _lines(count: int) -> Iterator[Line]:
    rows = [*_rows(count)]
    head = "time held\nsignal x, y : real\nsignal a : bool\nevent e\nrequirement R\n  "
    for name, form in FORMS["kinds"].items():
        for when, text in (("always", f"always ({form})"), ("upon", f"upon e then ({form})")):
            yield f"{name}, {when}", loads(f"{head}{text}\n"), rows, None, 0
    yield "each of 1,000 keys", loads(f"time held\n{KEYED}"), [*_keyed(count)], None, 0
    for name, form in FORMS["nested"].items():
        for window in (10, 100, 1000):
            text = form.format(long=window, short=window // 5)
            yield f"nested: {name}, {window} samples", loads(f"{head}{text}\n"), rows, None, 0
    for name, form in FORMS["amounts"].items():
        for window in (10, 1_000, 100_000):
            changing: list[Row] = [
                {"a": n % 2 == 0, "x": float(n % 7), "e": n % 3 == 0} for n in range(window + count)
            ]
            spec = loads(f"{head}{form.format(d=window)}\n")
            yield f"amount: {name} of {window:,} samples", spec, changing, None, window
    for file in sorted(PUBLISHED.glob("*.rv")):
        spec = load(file)
        own = [*_published(spec, file.read_text(), count // 2)]
        for name in spec.requirements:
            yield f"published: {file.stem} {name}", spec, own, name, 0


def _cost(spec: Spec, rows: Sequence[Row], only: str | None, filled: int) -> float:
    """Nanoseconds per sample, behind so many that fill a window."""
    best = math.inf
    for _ in range(PASSES):
        step = spec.monitor(only=[only] if only else None).step_ns
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


def measure(words: Sequence[str], rows: int) -> None:
    """Print what a sample costs, by requirement."""
    figures: list[float] = []

    def measured() -> Iterator[tuple[str, str]]:
        for line in _lines(rows):
            if not words or any(word in line[0] for word in words):
                figures.append(_cost(*line[1:]))
                yield line[0], f"{figures[-1]:,.0f}"

    show(["requirement", "ns a sample"], measured())
    print(f"{len(figures)} lines, median {statistics.median(figures):,.0f} ns", end="")
    print(f", most {max(figures):,.0f} ns")
