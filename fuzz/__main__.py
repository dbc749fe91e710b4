"""Fuzz rvmon: `python -m fuzz --seconds 600 [--only spec plans …] [--out out/fuzz]`.

Readers are fuzzed by atheris (`pip install atheris`), the native code by AFL++, see `fuzz.native`
(Debian's packages afl++ and libclang-rt-14-dev). Each target gets an equal share of the time, and
continues from the inputs it found before, in the folder of `--out`. Prints for each target the
number of inputs, how they ended, the coverage reached, and the inputs that failed; exits 1 if one
did. Inputs of readers whose failure is fixed become files of `fuzz/corpus`, which a test reads.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from benchmarks.program import program
from fuzz import native
from fuzz.targets import TARGETS, seeds

LONGEST = {"spec": 3000, "recording": 1000, "snapshot": 20_000}
"""The maximum length of an input in bytes; 12,000 for other targets."""

PATIENCE = 25
"""Time limit of an input in seconds."""


def by_atheris(name: str, folder: Path, seconds: int) -> tuple[str, Sequence[Path]]:
    """Fuzz a target with atheris; return a line about it and the inputs that failed."""
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
    return told, sorted(set(folder.glob("input-*")) - before)


def main(
    *,
    seconds: int = 600,
    only: Sequence[str] = (*TARGETS, *native.TARGETS),
    out: Path = Path("out/fuzz"),
) -> int:
    """Fuzz for the given number of seconds in total."""
    os.environ["RVMON_CACHE"] = "off"
    code = 0
    for name in only:
        is_native = name in native.TARGETS
        if not (shutil.which(native.COMPILER) if is_native else find_spec("atheris")):
            print(f"{name:12} not fuzzed: {'AFL++' if is_native else 'atheris'} is not installed")
            code = 1
            continue
        folder = out.resolve() / name
        folder.mkdir(parents=True, exist_ok=True)
        fuzz = native.by_afl if is_native else by_atheris
        told, stumbled = fuzz(name, folder, max(1, seconds // len(only)))
        print("\n  stumbled over ".join([f"{name:12} {told}", *map(str, stumbled)]), flush=True)
        code |= bool(stumbled)
    return code


if __name__ == "__main__":
    sys.exit(program(__doc__, main))
