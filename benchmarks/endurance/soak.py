"""A monitor that lives long: is its memory flat, are its steps short, are its verdicts right?

    python -m benchmarks.endurance soak --samples 100000000
    python -m benchmarks.endurance soak --samples 1000000000 --exported

A sample per millisecond, in a pattern of a second: attempts that overlap, keys that come again,
NaN, a signal that becomes stale. How many attempts pass and fail in each second is known, and
compared at the end. Python (`auto`, `python`) keeps 100 records of each verdict; `c` is the core in
a program of its own, which forgets records. It is not asked for R5, of which each attempt stays
undecided for ever: the core has such attempts open until its end. Prints memory after each tenth,
the times of steps with the time to ask the clock, and what is said where time itself ends, at 2^62
ns; exits 1 if a verdict is wrong.
"""

from __future__ import annotations

import argparse
import json
import struct
import subprocess
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.peers.adapters import resident_kib

import rvmon
from rvmon.core import amalgamate
from rvmon.errors import TraceError
from rvmon.monitor.planned import PlannedCore, planned_core
from rvmon.trace.time import TIME_LIMIT
from rvmon.verdict import Verdict

SPEC = """
spec soak
signal p : bool
signal speed : real [m/s]  stale after 10 ms
event go, odd
event pick(id: int), done(id: int)
requirement R1 "of attempts that overlap, four of ten fail"
  upon go
  then within 25 ms p
requirement R2 "an excess; what is not known in between leaves the last attempt undecided"
  always speed <= 1 m/s
requirement R3 "of five keys one is never done"
  upon pick
  then within 30 ms done.id == n
  for each n in pick.id
requirement R4 "a dropout is over in time"
  upon go
  then within 25 ms speed >= 0.5 m/s
requirement R5 "and here it is not: undecided for ever"
  upon odd
  then for 3 ms speed < 5 m/s
"""
STEP_NS = 1_000_000
ROWS = 1_000
TAIL = 60
"""Samples that say nothing, at the end: behind them no deadline is open."""

KNOWN = {
    "R1": (60, 40, 0),
    "R2": (0, 10, 0),
    "R3": (40, 10, 0),
    "R4": (100, 0, 0),
    "R5": (0, 0, 10),
}
"""How many attempts pass, fail and stay undecided in each second."""

BINS, BIN_NS = 400_000, 10
"""The times of steps are told apart to so many times so many nanoseconds."""


def pattern() -> list[dict[str, Any]]:
    """The samples of a second: ten times the same but for the keys."""
    return [_sample(row % 100, row // 100) for row in range(ROWS)]


def _sample(row: int, period: int) -> dict[str, Any]:
    found: dict[str, Any] = {"p": 30 <= row < 40 or 60 <= row < 70}
    if not 70 <= row < 90:  # it is stale from 79 to 90
        found["speed"] = float("nan") if 10 <= row < 15 else 2.0 if 45 <= row < 48 else 0.8
    if row % 10 == 0:
        found["go"] = True
    if row == 80:
        found["odd"] = True
    if row % 20 == 5:
        found["pick"] = {"id": 5 * period + row // 20}
    if row % 20 == 17 and row != 97:
        found["done"] = {"id": 5 * period + row // 20}
    return found


@dataclass(frozen=True, slots=True)
class Lived:
    """What came of a stream.

    Attributes:
        taken: samples.
        resident: KiB at the beginning and after each tenth.
        counts: by requirement, how many attempts passed, failed and stayed undecided.
        bins: times of a step, in `BIN_NS`, and how many steps took so long.
        longest: nanoseconds of the longest step.
    """

    taken: int
    resident: Sequence[int]
    counts: Mapping[str, Sequence[int]]
    bins: Sequence[tuple[int, int]]
    longest: int


def live_in_python(seconds: int, first: int, only: Sequence[str]) -> tuple[Lived, str]:
    """Feed a monitor of Python; also what it said where it refused a sample."""
    spec = rvmon.loads(SPEC)
    monitor = spec.monitor(keep=100, only=only)
    rows, step, clock = pattern(), monitor.step_ns, time.perf_counter_ns
    quiet: list[dict[str, Any]] = [{}] * TAIL
    bins = np.zeros(BINS, dtype=np.int64)
    resident, longest, t, said = [resident_kib()], 0, first, ""
    marks = {seconds * tenth // 10 for tenth in range(1, 11)}
    try:
        for second in range(seconds + 1):
            spent = []
            for row in rows if second < seconds else quiet:
                began = clock()
                step(t, row)
                spent.append(clock() - began)
                t += STEP_NS
            longest = max(longest, *spent)
            bins += np.bincount([min(one // BIN_NS, BINS - 1) for one in spent], minlength=BINS)
            if second + 1 in marks:
                resident.append(resident_kib())
    except TraceError as error:
        said = str(error)
    report = monitor.finish()
    told = Verdict.PASS, Verdict.FAIL, Verdict.INCONCLUSIVE
    counts = {name: [own[one] for one in told] for name, own in report.counts.items()}
    found = [(int(one), int(bins[one])) for one in bins.nonzero()[0]]
    return Lived((t - first) // STEP_NS, resident, counts, found, longest), said


def program(folder: Path, names: Sequence[str]) -> Path:
    compiled = rvmon.loads(SPEC)._compiled
    planned = planned_core(compiled, names)
    (folder / "pattern.h").write_text("\n".join(_header(planned)))
    sources = [f"{amalgamate.FOLDER}/{name}" for name in amalgamate.core_files()]
    words = [
        "cc",
        "-std=gnu99",
        "-O2",
        "-ffp-contract=off",
        f"-I{folder}",
        f"-I{amalgamate.FOLDER}",
    ]
    words += [*sources, str(Path(__file__).with_suffix(".c"))]
    subprocess.run([*words, "-lm", "-o", str(folder / "soak")], check=True)
    return folder / "soak"


def _header(planned: PlannedCore) -> Iterator[str]:
    """The plan, and the pattern as updates: those of each row, and where they begin."""
    plan = struct.unpack(f"={len(planned.packed.data) // 8}Q", planned.packed.data)
    fields: list[str] = []
    updates: list[str] = []
    first = [0]
    for row in pattern():
        for name, value in row.items():
            if name not in planned.numbers:  # only R5 reads it
                continue
            of = "NULL"
            if isinstance(value, dict):
                of = f"&fields[{len(fields)}]"
                fields.append(_number(value["id"]))
            says = "RV_SAYS_UNKNOWN" if value != value else "RV_SAYS_YES"
            held = _number(0 if isinstance(value, dict) or value != value else value)
            updates.append(f"{{{planned.numbers[name]}, {says}, {held}, {of}}}")
        first.append(len(updates))
    yield '#include "core.h"'
    yield f"#define ROWS {ROWS}"
    yield f"static const uint64_t plan[] = {{{', '.join(f'{word}u' for word in plan)}}};"
    yield f"static const rv_number fields[] = {{{', '.join(fields)}}};"
    yield f"static const rv_update updates[] = {{{', '.join(updates)}}};"
    yield f"static const int32_t first[] = {{{', '.join(map(str, first))}}};"


def _number(value: float) -> str:
    if isinstance(value, int):
        return f"{{RV_WHOLE, {{.whole = {int(value)}}}}}"
    return f"{{RV_REAL, {{.real = {value!r}}}}}"


def live_in_c(path: Path, seconds: int, first: int, names: Sequence[str]) -> tuple[Lived, str]:
    """Feed the core, which refuses a sample without a word."""
    words = [str(path), str(seconds), str(first), str(TAIL)]
    told = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
    counts = {
        name: [passed, failed, undecided]
        for name, (failed, passed, undecided) in zip(names, told["counts"], strict=True)
    }
    lived = Lived(told["taken"], told["resident"], counts, told["bins"], told["longest"])
    whole = told["taken"] == seconds * ROWS + TAIL
    return lived, "" if whole else "rv_step returned no RV_OK"


def expected(name: str, seconds: int) -> list[int]:
    """How the attempts of a requirement end in so many seconds."""
    passed, failed, undecided = (seconds * one for one in KNOWN[name])
    return [passed, failed, undecided + (name == "R2")]  # it goes on, and was unknown


def quantile(bins: Sequence[tuple[int, int]], share: float) -> int:
    """Nanoseconds that such a share of the steps did not exceed, rounded up."""
    left = share * sum(count for _, count in bins)
    for place, count in bins:
        left -= count
        if left <= 0:
            return (place + 1) * BIN_NS
    raise AssertionError("there is no step")


def main(words: Sequence[str]) -> int:
    """Feed, compare, print, and return 1 if a verdict is wrong."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--samples", type=int, default=1_000_000)
    parser.add_argument("--exported", action="store_true", help="the core as C, without Python")
    parser.add_argument("--only", nargs="+", choices=KNOWN, default=list(KNOWN))
    options = parser.parse_args(words)
    seconds = max(10, options.samples // ROWS)
    names = [one for one in KNOWN if one in options.only]
    if options.exported:
        names = [one for one in names if not KNOWN[one][2]]
    with tempfile.TemporaryDirectory() as folder:
        built = program(Path(folder), names) if options.exported else None

        def live(span: int, first: int) -> tuple[Lived, str]:
            if built is not None:
                return live_in_c(built, span, first, names)
            return live_in_python(span, first, names)

        began = time.perf_counter()
        lived, _ = live(seconds, 0)
        spent = time.perf_counter() - began
        last, said = live(2, TIME_LIMIT - 1500 * STEP_NS)
    print(f"{lived.taken:,} samples in {spent:.0f} s")
    print("memory, MiB: " + " ".join(f"{kib / 1024:.1f}" for kib in lived.resident))
    times = [quantile(lived.bins, share) / 1000 for share in (0.5, 0.999)]
    longest = lived.longest / 1000
    print(f"a step, µs: p50 {times[0]:.2f}, p99.9 {times[1]:.2f}, longest {longest:,.0f}")
    wrong = 0
    for name, found in lived.counts.items():
        known = expected(name, seconds)
        wrong += found != known
        mark = "as known" if found == known else f"WRONG, it is {known}"
        print(f"{name}: {found[0]:,} P, {found[1]:,} F, {found[2]:,} I: {mark}")
    # One second and a half to the end: the samples before it are judged, the one behind is refused.
    found = last.counts.get("R1", [90, 58, 2])
    whole = last.taken == 1500 and found == [90, 58, 2] and bool(said)
    print(f"the end of time: {last.taken:,} samples are taken, then: {said}")
    print(f"  R1 {found}: {'as known' if whole else 'WRONG'}")
    return 1 if wrong or not whole else 0
