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

import gc
import math
import random
import re
import statistics
import time
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
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


@dataclass(frozen=True, slots=True)
class Stream:
    """A specification and samples."""

    spec: Spec
    rows: Sequence[Row]
    period: int = SECOND  # ticks from one to the next
    before: int = 0  # samples that are not measured
    only: Sequence[str] | None = None  # the requirements that are meant; `None`: all
    keep: int | None = None  # so many records of each verdict

    def cost(self) -> float:
        """CPU nanoseconds of a sample, `step` and what it hands out."""
        step, period = self.spec.monitor(only=self.only, keep=self.keep).step_ns, self.period
        for place, row in enumerate(self.rows[: self.before]):
            step(place * period, row)
        measured = self.rows[self.before :]
        gc.freeze()  # what a collection costs is what the stream leaves, not what the process holds
        began = time.process_time_ns()
        for place, row in enumerate(measured, self.before):
            step(place * period, row)
        spent = time.process_time_ns() - began
        gc.unfreeze()
        return spent / len(measured)


KEYED = """event ask(id : int)
event done(id : int)
requirement R
  upon ask then within 5000 s done.id == i
  for each i in ask.id
"""


def drawn(count: int, unknown: float = 0, events: float = 0) -> list[Row]:
    """Samples of which all values are new; shares of NaN and of samples with the event."""
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


def _streams(count: int) -> Iterator[tuple[str, Stream]]:
    rows = drawn(count, events=0.05)
    head = "time held\nsignal x, y : real\nsignal a : bool\nevent e\nrequirement R\n  "
    for name, form in FORMS["kinds"].items():
        for when, text in (("always", f"always ({form})"), ("upon", f"upon e then ({form})")):
            yield f"{name}, {when}", Stream(loads(f"{head}{text}\n"), rows)
    yield "each of 1,000 keys", Stream(loads(f"time held\n{KEYED}"), [*_keyed(count)])
    for name, form in FORMS["nested"].items():
        for window in (10, 100, 1000):
            text = form.format(long=window, short=window // 5)
            yield f"nested: {name}, {window} samples", Stream(loads(f"{head}{text}\n"), rows)
    for name, form in FORMS["amounts"].items():
        for window in (10, 1_000, 100_000):
            changing: list[Row] = [
                {"a": n % 2 == 0, "x": float(n % 7), "e": n % 3 == 0} for n in range(window + count)
            ]
            spec = loads(f"{head}{form.format(d=window)}\n")
            yield f"amount: {name} of {window:,} samples", Stream(spec, changing, before=window)
    for file in sorted(PUBLISHED.glob("*.rv")):
        spec = load(file)
        own = [*_published(spec, file.read_text(), count // 2)]
        for name in spec.requirements:
            yield f"published: {file.stem} {name}", Stream(spec, own, only=[name])


def measure(words: Sequence[str], rows: int) -> None:
    """Print what a sample costs, by requirement."""
    figures: list[float] = []

    def measured() -> Iterator[tuple[str, str]]:
        for name, stream in _streams(rows):
            if not words or any(word in name for word in words):
                figures.append(min(stream.cost() for _ in range(PASSES)))
                yield name, f"{figures[-1]:,.0f}"

    show(["requirement", "ns a sample"], measured())
    print(f"{len(figures)} lines, median {statistics.median(figures):,.0f} ns", end="")
    print(f", most {max(figures):,.0f} ns")
