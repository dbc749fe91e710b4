"""Fuzz rvmon: `python -m fuzz --seconds 60 [--only spec recording …] [--out out/fuzz]`.

It needs atheris (`pip install atheris`). Each target has its part of the time, and goes on from
what it found before, in the folder of `--out`. Prints by target how many inputs it took, how they
ended, how many places of the code were reached, and which inputs stumbled; exits 1 if one did. Once
it is fixed, that input is a file more in `fuzz/corpus`, which a test reads.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from benchmarks.program import program
from fuzz.driver import Found, fuzz
from fuzz.targets import TARGETS, seeds

LONGEST = {"spec": 3000, "recording": 1000, "snapshot": 20_000}
"""Bytes of an input; of others 12,000."""

PATIENCE = 25
"""Seconds that an input may take."""


def by_atheris(name: str, folder: Path, seconds: int) -> Found:
    """Have atheris change inputs of a target for so many seconds."""
    (folder / "found").mkdir(exist_ok=True)
    before = set(folder.glob("input-*"))
    for number, data in enumerate(seeds(name)):
        (folder / "found" / f"seed-{number}").write_bytes(data)
    words = [sys.executable, "-m", "fuzz.one", name, str(folder), str(folder / "found")]
    words += [f"-max_total_time={seconds}", f"-timeout={PATIENCE}", "-rss_limit_mb=2500"]
    words += [f"-artifact_prefix={folder}/input-", f"-max_len={LONGEST.get(name, 12_000)}"]
    with (folder / "log.txt").open("w") as log:
        subprocess.run([*words, "-print_final_stats=1"], stdout=log, stderr=log, check=False)
    text = (folder / "log.txt").read_text(errors="replace")
    inputs = re.findall(r"(?:number_of_executed_units: |^#)(\d+)", text, re.MULTILINE)
    reached = re.findall(r"cov: (\d+)", text)[-1:] or ["no"]
    answers = folder / "answers.json"
    ends = json.loads(answers.read_bytes()) if answers.exists() else {}
    ended = ", ".join(f"{end} {count:,}" for end, count in sorted(ends.items()))
    told = f"{max(map(int, inputs), default=0):>9,} inputs, {reached[0]} edges; {ended}"
    return Found(told, sorted(set(folder.glob("input-*")) - before))


def main(
    *, seconds: int = 60, only: Sequence[str] = (*TARGETS,), out: Path = Path("out/fuzz")
) -> int:
    """Fuzz for so many seconds in all."""
    if find_spec("atheris") is None:
        print("nothing is fuzzed, as atheris is not installed")
        return 1
    os.environ["RVMON_CACHE"] = "off"
    return fuzz(only, by_atheris, out, seconds)


if __name__ == "__main__":
    sys.exit(program(__doc__, main))
