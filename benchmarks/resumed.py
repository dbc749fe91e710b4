"""Kill runs again and again at random instants, and have them go on: is anything lost, or double?

    python -m benchmarks.resumed --kills 50 --seed 1

A campaign of the handover with two processes, and `rvmon run` over recordings, are each ended by
SIGKILL so often, with all that they began, and begun again by the same command. What they have
written in the end is held against what they write undisturbed, but for the seconds that it took.
Prints how many kills left what could be gone on with; exits 1 if a file differs.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SECONDS = re.compile(rb'("seconds": ?|simulated in |\bin )[\d.]+|"spent": ?[\d.]+')

SPEC = """spec resumed
signal x : real
requirement R1
  always (x > 1 -> eventually[0, 50 s] x < -1)
"""


def _recordings(folder: Path, count: int, rows: int, dice: random.Random) -> None:
    (folder / "s.rv").write_text(SPEC)
    for number in range(count):
        lines = [f"{row},{dice.gauss(0, 1):.3f}" for row in range(rows)]
        (folder / f"r{number:03}.csv").write_text("\n".join(["t,x", *lines, ""]))


def _written(folder: Path) -> dict[str, bytes]:
    """Tables and tests; pages and databases hold when and how they were made."""
    return {
        str(path.relative_to(folder)): SECONDS.sub(b"", path.read_bytes())
        for path in sorted(folder.rglob("*"))
        if path.suffix in (".csv", ".json", ".tex")
    }


def _killed(words: list[str], folder: Path, out: Path, kills: int, dice: random.Random) -> str:
    """Run a command undisturbed, then another way to the same; what is to be told."""
    options = {"cwd": folder, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    began = time.monotonic()
    subprocess.run(words, check=False, **options)
    took = time.monotonic() - began
    known = _written(out)
    shutil.rmtree(out)
    out.mkdir()
    done = on_the_way = finished = 0
    while done < kills:
        with subprocess.Popen(words, start_new_session=True, **options) as process:
            try:
                process.wait(dice.uniform(0.1, took))
                finished += 1
            except subprocess.TimeoutExpired:
                done += 1
                os.killpg(process.pid, signal.SIGKILL)
        left = [path for path in out.rglob("*") if path.suffix in (".journal", ".unfinished")]
        on_the_way += bool(left)
        if not left and _written(out) != known and _written(out):
            return f"DIFFERS after {done} kills"
        if not left:
            shutil.rmtree(out)
            out.mkdir()
    subprocess.run(words, check=False, **options)
    same = "same" if _written(out) == known else "DIFFERS"
    return f"{done} kills, {on_the_way} left something, {finished} came to an end: {same}"


def main() -> int:
    """Run both and print what came out."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tests", type=int, default=40)
    arguments = parser.parse_args()
    dice = random.Random(arguments.seed)
    wrong = False
    for what in ("handover run", "rvmon run"):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            out = folder / "out"
            out.mkdir()
            if what == "rvmon run":
                _recordings(folder, 200, 2000, dice)
                words = ["rvmon", "run", "s.rv", ".", "--jobs", "2", "--resume", "--out"]
                words.append("out/v.csv")
            else:
                words = ["handover.cli", "run", "--tests", str(arguments.tests), "--legacy"]
                words += ["--jobs", "2", "--out", "out"]
            told = _killed([sys.executable, "-m", *words], folder, out, arguments.kills, dice)
            wrong |= "DIFFERS" in told
            print(f"{what:<14}{told}")
    return int(wrong)


if __name__ == "__main__":
    sys.exit(main())
