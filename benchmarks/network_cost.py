"""What windows within windows cost per sample: by form, by length, by how often inputs change.

    python -m benchmarks.network_cost [WORD ...]

One requirement that no automaton closes for; processor time, all in. First forms of nested windows
over values that change at every row, with so many samples in the longer window; then one form by
how often its inputs change. With words, only the lines that have one of them.
"""

from __future__ import annotations

import random
import sys
import time
from collections.abc import Iterator

from rvmon.session import loads

FORMS = {
    "F G": "upon x > 8 then F[0 s, {long}] G[0 s, {short}] x < 6",
    "G F": "upon start then G[0 s, {long}] F[0 s, {short}] x > 5",
    "stop": "upon e then F[0 s, {short}] G[0 s, {long}] x <= 9.9",
    "recurrence": "always (x > 8 -> F[0 s, {long}] G[0 s, {short}] x < 6)",
    "delayed": "whenever x > 8 then F[{short}, {long}] y > 5",
    "either": "upon x > 8 then F[0 s, {long}] (x < 4 | G[0 s, {short}] y < 6)",
    "until": "upon x > 8 then (F[0 s, {short}] x < 6) U[0 s, {long}] G[0 s, {short}] y < 6",
}
"""Over windows of two lengths, the shorter a fifth of the longer."""

WINDOWS = (10, 100, 1000)
RATES = (10, 100)
ROWS = 4000

RARELY = "whenever a then F[2 s, 5 s] b"
CHANCES = (
    ("held", 600_000, 0.001),
    ("held", 60_000, 0.01),
    ("held", 10_000, 0.5),
    ("sampled", 10_000, 0.01),
)
"""Time model, samples at 1 kHz, and the chance that a signal changes in one."""

SECOND = 10**9


def rows_of(count: int) -> list[dict[str, float | bool]]:
    """Samples in which all values change, and now and then an event occurs."""
    rng = random.Random(1)
    rows: list[dict[str, float | bool]] = []
    for _ in range(count):
        row: dict[str, float | bool] = {"x": rng.uniform(0, 10), "y": rng.uniform(0, 10)}
        if rng.random() < 0.05:
            row["e"] = True
        rows.append(row)
    return rows


def seconds_of(text: str, rows: list[dict[str, float | bool]], gap: int) -> tuple[float, str]:
    """Seconds of processor time for samples that are so many ticks apart, and the verdict."""
    monitor = loads(text).monitor(keep=100)
    began = time.process_time()
    for index, row in enumerate(rows):
        monitor.step_ns(index * gap, row)
    seconds = time.process_time() - began
    return seconds, monitor.finish().verdicts["R1"].value


def nested() -> Iterator[tuple[str, str, list[dict[str, float | bool]], int]]:
    """Name, specification, samples and ticks between them, of each form of nested windows."""
    rows = rows_of(ROWS)
    for name, form in FORMS.items():
        for model in ("held", "sampled"):
            for rate in RATES:
                for window in WINDOWS:
                    gap = SECOND // rate
                    long, short = f"{window * gap} ns", f"{window * gap // 5} ns"
                    text = form.format(long=long, short=short)
                    yield (
                        f"{name:10} {model:8} {rate:4} Hz {window:5} samples",
                        f"spec s\ntime {model}\nsignal x, y : real\nevent e\n"
                        f"requirement R1\n  {text}\n",
                        rows,
                        gap,
                    )


def rare() -> Iterator[tuple[str, str, list[dict[str, float | bool]], int]]:
    """The same of one form, by how often its inputs change."""
    for model, samples, chance in CHANCES:
        rng = random.Random(1)
        values: dict[str, float | bool] = {"a": False, "b": False}
        rows = []
        for _ in range(samples):
            values = {name: bool(one) ^ (rng.random() < chance) for name, one in values.items()}
            rows.append(values)
        yield (
            f"changes    {model:8} {2 * chance:7.3f} per sample",
            f"spec s\ntime {model}\nsignal a, b : bool\nrequirement R1\n  {RARELY}\n",
            rows,
            SECOND // 1000,
        )


def main(words: list[str]) -> int:
    """Measure and print."""
    _, text, rows, gap = next(nested())
    seconds_of(text, rows[:200], gap)  # what is imported when it is needed
    for lines in (nested(), rare()):
        for name, text, rows, gap in lines:
            if words and not any(word in name for word in words):
                continue
            seconds, verdict = seconds_of(text, rows, gap)
            print(f"  {name:40} {1e9 * seconds / len(rows):9,.0f} ns per sample, {verdict}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
