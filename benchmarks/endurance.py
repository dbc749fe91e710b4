"""Endurance tests: a monitor that runs for long, and processes that are killed.

    python -m benchmarks.endurance soak --samples 100000000
    python -m benchmarks.endurance kills --kills 200 [--only "rvmon run --resume" …]

`soak` feeds a sample per millisecond, in a pattern that repeats every second: overlapping attempts,
recurring keys, NaN, a signal that becomes stale. The number of attempts that pass and fail in each
second is known, and compared at the end. Prints memory after each tenth, and the times of steps.

`kills` starts resumable runs (`rvmon watch --state`, `rvmon run --resume`, shards, a campaign),
kills them at random points, and restarts them until they end. Their output is compared with that of
undisturbed runs. Exits 1 if anything is wrong.
"""

from __future__ import annotations

import math
import random
import re
import shutil
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.process import mebibytes
from benchmarks.program import program
from tests.rvmon.live import killed_watch
from tests.rvmon.live.killed_watch import Forked

import handover.cli
import rvmon
from rvmon import cli
from rvmon.verdicts import Verdict

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
"""Empty samples at the end, after which no deadline is open."""

BINS, BIN_NS = 400_000, 10
"""The histogram of step times: number of bins, and nanoseconds per bin."""

KNOWN = {
    "R1": (60, 40, 0),
    "R2": (0, 10, 0),
    "R3": (40, 10, 0),
    "R4": (100, 0, 0),
    "R5": (0, 0, 10),
}
"""The number of attempts that pass, fail and stay undecided in each second."""


def _sample(row: int, period: int) -> dict[str, Any]:
    """A sample of the pattern: row of 100, repeated ten times a second with other keys."""
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


def soak(*, samples: int = 1_000_000) -> int:
    """Run a monitor that keeps 100 records of each verdict; exit 1 if a count is wrong."""
    seconds = max(10, samples // ROWS)
    monitor = rvmon.loads(SPEC).monitor(keep=100)
    rows = [_sample(row % 100, row // 100) for row in range(ROWS)]
    step, clock, t, started = monitor.step_ns, time.perf_counter_ns, 0, time.perf_counter()
    resident, bins, longest = [mebibytes("self", "VmRSS")], np.zeros(BINS, np.int64), 0
    for second in range(seconds + 1):
        spent = []
        for row in rows if second < seconds else [{}] * TAIL:
            began = clock()
            step(t, row)
            spent.append(clock() - began)
            t += STEP_NS
        longest = max(longest, *spent)
        bins += np.bincount([min(one // BIN_NS, BINS - 1) for one in spent], minlength=BINS)
        if (second + 1) * 10 % seconds < 10 and second < seconds:
            resident.append(mebibytes("self", "VmRSS"))
    print(f"{t // STEP_NS:,} samples in {time.perf_counter() - started:.0f} s")
    print("memory, MiB: " + " ".join(f"{one:.1f}" for one in resident))
    steps = bins.cumsum()
    middle, high = (np.searchsorted(steps, np.array((0.5, 0.999)) * steps[-1]) + 1) * BIN_NS / 1000
    print(f"a step, µs: p50 {middle:.2f}, p99.9 {high:.2f}, longest {longest / 1000:,.0f}")
    wrong = 0
    for name, counts in monitor.finish().counts.items():
        found = [counts[one] for one in (Verdict.PASS, Verdict.FAIL, Verdict.INCONCLUSIVE)]
        known = [seconds * one for one in KNOWN[name]]
        known[2] += name == "R2"  # its last attempt continues to the end and met unknown values
        wrong += found != known
        mark = "as known" if found == known else f"WRONG, it is {known}"
        print(f"{name}: {found[0]:,} P, {found[1]:,} F, {found[2]:,} I: {mark}")
    return int(wrong > 0)


_JUDGE = "rvmon run s.rv . --out out/v.csv --resume"
RESUMED = {
    "rvmon run --resume": [_JUDGE],
    "rvmon run --jobs 2 --resume": [f"{_JUDGE} --jobs 2"],
    "rvmon run --shard": [f"{_JUDGE} --shard 1/2", f"{_JUDGE} --shard 2/2", _JUDGE],
    "handover run, resumed": ["handover run --tests 40 --legacy --jobs 2 --out out"],
}
"""Commands that are killed, with all their subprocesses, and restarted until they finish."""

SECONDS = re.compile(rb'("seconds": ?|simulated in |\bin )[\d.]+|"spent": ?[\d.]+')
RESUMED_SPEC = """spec resumed
signal x : real
requirement R1
  always (x > 1 -> eventually[0, 50 s] x < -1)
"""


def _written(folder: Path) -> dict[str, bytes]:
    """The tables and tests written; pages and databases also record when they were made."""
    return {
        str(path.relative_to(folder)): SECONDS.sub(b"", path.read_bytes())
        for path in sorted(folder.rglob("*"))
        if path.suffix in (".csv", ".json", ".tex")
    }


def _main(words: str) -> object:
    program, *arguments = words.split(" ")
    return {"rvmon": cli.main, "handover": handover.cli.main}[program](arguments)


def _kept(out: Path) -> int:
    """The size in bytes of the journals of unfinished runs."""
    size = 0
    for path in out.rglob("*"):
        with suppress(FileNotFoundError):  # the run has just finished and removed it
            size += path.stat().st_size * (path.suffix in (".journal", ".unfinished"))
    return size


def _resumed(kind: str, folder: Path, kills: int, dice: random.Random) -> Counter[str]:
    """Run commands once undisturbed, then kill and restart them until there were enough kills.

    Each kill interrupts real work: it comes when the journal has grown by a random size.
    """
    (folder / "s.rv").write_text(RESUMED_SPEC)
    for number in range(100):
        lines = [f"{row},{dice.gauss(0, 1):.3f}" for row in range(300)]
        (folder / f"r{number:03}.csv").write_text("\n".join(["t,x", *lines, ""]))
    found, out, full = Counter[str](), folder / "out", Counter[str]()
    known: Mapping[str, bytes] = {}
    while not known or found["kills"] < kills:
        out.mkdir()
        for words in RESUMED[kind]:
            is_over = False
            while not is_over:
                least = _kept(out) + (dice.uniform(1, full[words] / 5) if known else math.inf)

                def is_time(words: str = words, least: float = least) -> bool:
                    full[words] = max(full[words], _kept(out))
                    return _kept(out) > least

                process = Forked(partial(_main, words), folder, folder / "told")
                is_over = not process.kill_when(is_time)
                found["kills"] += not is_over
        known = known or _written(out)
        found["runs to the end"] += 1
        found["changed"] += _written(out) != known
        found["left behind"] += _kept(out) > 0
        shutil.rmtree(out)
    return found


def _watched(_: str, folder: Path, kills: int, dice: random.Random) -> Counter[str]:
    """Compare the verdicts of a repeatedly killed watch with those of an undisturbed one."""
    seed = dice.randrange(1 << 30)
    killed_watch.written(folder, seed, 40 * kills)
    expected, found, done = killed_watch.killed(folder, kills, seed)
    return Counter(
        {
            "kills": done,
            "verdicts": len(expected),
            "lost": len(expected.keys() - found.keys()),
            "of nobody": len(found.keys() - expected.keys()),
            "changed": sum(found[n] != expected[n] for n in found.keys() & expected),
        }
    )


KINDS = {**dict.fromkeys(RESUMED, _resumed), "rvmon watch --state": _watched}
WRONG = ("changed", "left behind", "lost", "of nobody")
"""The counts that must be 0."""


def kills(*, kills: int = 50, seed: int = 1, only: Sequence[str] = (*KINDS,)) -> int:
    """Kill each kind of process `kills` times; exit 1 if anything is wrong."""
    bad = 0
    for kind in only:
        with tempfile.TemporaryDirectory() as folder:
            found = KINDS[kind](kind, Path(folder), kills, random.Random(seed))
        print(f"{kind}: {kills} kills")
        for what, count in sorted(found.items()):
            print(f"  {what}: {count:,}", flush=True)
        bad += sum(found[what] for what in WRONG)
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(program(__doc__, soak, kills))
