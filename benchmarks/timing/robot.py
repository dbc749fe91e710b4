"""A robot beside a person: a stream of its signals, and requirements on it.

A handover is requested, granted or withheld; a person comes near and the arm stops; speed and
distance vary at every row. All requirements hold throughout.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator

from benchmarks.timing.workload import Workload, formula
from tests.tools.common_fragment import names_in

RATES = {"20 Hz": 20, "1 kHz": 1000}

FLAGS = ("request", "granted", "withheld", "released", "near", "stopped")
SECOND = 1_000_000_000


def stream(rate: int, rows: int, seed: int = 1) -> dict[str, list[bool | float]]:
    """The signals at so many rows a second.

    Args:
        rate: rows a second.
        rows: the length.
        seed: of the random choices.
    """
    rng = random.Random(f"robot/{rate}/{seed}")
    flags: dict[str, list[bool | float]] = {name: [False] * rows for name in FLAGS}

    def hold(name: str, start: float, seconds: float) -> None:
        for row in range(int(start), min(int(start + max(seconds * rate, 1)), rows)):
            flags[name][row] = True

    row = 0.0
    while row < rows:
        answer = row + rng.uniform(0.2, 2.9) * rate
        hold("request", row, 0)
        if rng.random() < 0.7:
            hold("granted", answer, 0.1)
            hold("released", answer + 0.3 * rate, 0.1)
        else:
            hold("granted", answer, 0.1)
            hold("withheld", answer + 0.2 * rate, 0)
        near = answer + 3.5 * rate
        hold("near", near, 1)
        hold("stopped", near + rng.uniform(0.05, 0.25) * rate, 1.5)
        row = near + rng.uniform(2, 4) * rate
    return {
        **flags,
        "distance": [0.8 + 0.25 * math.sin(i / rate) for i in range(rows)],
        "speed": [0.15 + 0.05 * math.cos(3 * i / rate) for i in range(rows)],
    }


def properties(rate: int) -> Iterator[tuple[str, str, str]]:
    """Name, form and formula of each requirement; bounds in rows at this rate."""
    three, two, one, tenth = (f"{n * rate // 10} ns" for n in (30, 20, 10, 1))
    late, soon = f"{3 * rate + 1} ns", f"{3 * rate // 10} ns"
    yield "answered in 3 s", "future", f"request -> eventually[0 ns, {three}] granted"
    yield "answered in 3 s", "past", f"not ((not granted) since[{late}, inf) request)"
    yield "withheld for 2 s", "future", f"withheld -> always[0 ns, {two}] not released"
    yield "withheld for 2 s", "past", f"released -> historically[0 ns, {one}] not withheld"
    yield "slow when close", "past", "distance < 0.65 -> speed <= 0.25"
    stopping = f"eventually[0 ns, {soon}] always[0 ns, {tenth}] stopped"
    yield "stops in 0.3 s", "future", f"near -> (stopped or {stopping})"


def workloads(seconds: int) -> Iterator[Workload]:
    """Each requirement at each rate on a stream of so many seconds."""
    for label, rate in RATES.items():
        rows = seconds * rate
        columns = stream(rate, rows)
        for name, form, text in properties(rate):
            asked = formula(text, ", ".join(FLAGS), "distance, speed")
            used = {key: columns[key] for key in sorted(names_in(asked))}
            yield Workload("robot", f"{name}, {label}", form, (asked,), used, SECOND // rate)
