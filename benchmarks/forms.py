"""Nanoseconds per event of each runtime form, on robot properties at 20 Hz.

    python -m benchmarks.forms [--rows N] [--rounds N]

Every form's verdicts and attempts are compared first; a row is printed only if they are equal.
CPU time of this process, median over interleaved rounds.
"""

from __future__ import annotations

import argparse
import gc
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import rvmon
from rvmon.verdict.report import Report

HEAD = "spec robot\ntime held\nsignal p, q, r : bool\nsignal speed : real\n"
PROPERTIES = {
    "absence after": "upon rise(q)\n then for 10 s not p",
    "response": "upon rise(p)\n then within 3 s q",
    "universality": "always speed < 2.5",
    "recurrence": "whenever not r\n then within 30 s p",
}


@dataclass(frozen=True, slots=True)
class Stream:
    """One recording, as columns and as samples that carry all values."""

    times: np.ndarray[Any, np.dtype[np.int64]]
    columns: dict[str, np.ndarray[Any, Any]]
    samples: list[tuple[int, dict[str, Any]]]


def stream(rows: int, changing: float) -> Stream:
    """Samples of which about this share changes a truth value."""
    rng = np.random.default_rng(1)
    columns: dict[str, np.ndarray[Any, Any]] = {
        name: np.cumsum(rng.random(rows) < changing / 3) % 2 == 1 for name in "pqr"
    }
    columns["speed"] = 1 + np.abs(np.sin(np.arange(rows) / 50)) + 0.1 * rng.random(rows)
    times = np.arange(rows, dtype=np.int64) * 50_000_000
    names = list(columns)
    rows_of = zip(*(columns[name].tolist() for name in names), strict=True)
    samples = [
        (t, dict(zip(names, row, strict=True)))
        for t, row in zip(times.tolist(), rows_of, strict=True)
    ]
    return Stream(times, columns, samples)


Form = Callable[[], tuple[float, Any]]
"""Judges once; gives CPU seconds and what is to be equal to the other forms."""


def outcome(report: Report) -> Any:
    """What forms have to agree on."""
    return [(a.requirement, a.number, a.triggered, a.decided, a.verdict) for a in report.attempts]


def online(spec: rvmon.Spec, given: Stream, engine: str) -> Form:
    """A monitor stepped sample by sample."""

    def once() -> tuple[float, Any]:
        monitor = spec.monitor(engine=engine)
        step = monitor.step_ns
        began = time.process_time()
        for t, values in given.samples:
            step(t, values)
        spent = time.process_time() - began
        return spent, outcome(monitor.finish_ns())

    return once


def batch(spec: rvmon.Spec, given: Stream, engine: str) -> Form:
    """`Spec.evaluate` on arrays."""
    table = {"t_ns": given.times, **given.columns}

    def once() -> tuple[float, Any]:
        began = time.process_time()
        report = spec.evaluate(table, time="t_ns", engine=engine)
        return time.process_time() - began, outcome(report)

    return once


def measure(forms: dict[str, Form], rounds: int) -> dict[str, list[float]]:
    """CPU seconds per form and round, interleaved.

    Raises:
        SystemExit: two forms judge differently.
    """
    spent: dict[str, list[float]] = {name: [] for name in forms}
    expected: Any = None
    for _ in range(rounds):
        for name, form in forms.items():
            gc.collect()
            seconds, found = form()
            expected = found if expected is None else expected
            if [tuple(map(str, one)) for one in found] != [tuple(map(str, x)) for x in expected]:
                sys.exit(f"{name} judges otherwise: no figures")
            spent[name].append(seconds)
    return spent


def main(argv: list[str]) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--rows", type=int, default=100_000)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args(argv)
    print(f"{options.rows} samples of 4 values at 20 Hz; ns per sample, median of {options.rounds}")
    for changing in (0.001, 0.01, 0.1):
        given = stream(options.rows, changing)
        for title, body in PROPERTIES.items():
            text = f'{HEAD}requirement R1 "{title}"\n {body}\n'
            spec = rvmon.loads(text)
            forms = {
                "engine": online(spec, given, "automaton"),
                "generated": online(spec, given, "python"),
                "columns": batch(spec, given, "auto"),
                "c": online(spec, given, "c"),
                "c columns": batch(spec, given, "c"),
            }
            show(
                f"{title}, {100 * changing:g} % changing",
                measure(forms, options.rounds),
                options.rows,
            )
    many(options)
    return 0


def many(options: argparse.Namespace) -> None:
    """K requirements on one stream, one signal each; a sample brings one, 1 % of them change it."""
    for count in (1, 10, 100):
        declared = "".join(f"signal s{n} : bool\n" for n in range(count))
        rules = "".join(
            f'requirement R{n} "r"\n upon rise(s{n})\n then within 3 s not s{n}\n'
            for n in range(count)
        )
        spec = rvmon.loads(f"spec many\n{declared}{rules}")
        rng = np.random.default_rng(2)
        names = rng.integers(0, count, options.rows).tolist()
        flips = (rng.random(options.rows) < 0.01).tolist()
        now = [False] * count
        samples = []
        for t, (n, flip) in enumerate(zip(names, flips, strict=True)):
            now[n] ^= flip
            samples.append((t * 50_000_000, {f"s{n}": now[n]}))
        given = Stream(np.zeros(0, np.int64), {}, samples)
        forms = {
            "generated": online(spec, given, "python"),
            "c": online(spec, given, "c"),
        }
        show(f"{count} requirements, one concerned", measure(forms, options.rounds), options.rows)


def show(title: str, spent: dict[str, list[float]], rows: int) -> None:
    """Print a row."""
    figures = "  ".join(
        f"{name} {1e9 * statistics.median(seconds) / rows:9.1f}" for name, seconds in spent.items()
    )
    print(f"{title:34} {figures}", flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
