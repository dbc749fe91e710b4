"""Fuzz rvmon: `python -m fuzz --seconds 60 [--only spec recording …] [--out out/fuzz]`.

It needs atheris (`pip install atheris`). Each target has its part of the time, and goes on from
what it found before, in the folder of `--out`. Prints by target how many inputs it took, how they
ended, how many places of the code were reached, and which inputs stumbled; exits 1 if one did. Once
it is fixed, that input is a file more in `fuzz/corpus`, which a test reads.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from fuzz.targets import TARGETS, seeds

LONGEST = {"spec": 3000, "recording": 1000, "snapshot": 20_000}
"""Bytes of an input; of others 12,000."""

PATIENCE = 25
"""Seconds that an input may take."""


@dataclass(frozen=True, slots=True)
class Found:
    """What came of a target."""

    inputs: int
    places: str
    answers: str
    stumbled: tuple[Path, ...]


def fuzz_target(name: str, out: Path, seconds: int) -> Found:
    """Have atheris change inputs of a target for so many seconds."""
    folder = out / name
    (folder / "found").mkdir(parents=True, exist_ok=True)
    before = set(folder.glob("input-*"))
    words = [sys.executable, "-m", "fuzz.one", name, str(folder)]
    for number, data in enumerate(seeds(name)):
        (folder / "found" / f"seed-{number}").write_bytes(data)
    words += [str(folder / "found"), f"-max_total_time={seconds}"]
    words += [f"-timeout={PATIENCE}", "-rss_limit_mb=2500", "-print_final_stats=1"]
    words += [f"-artifact_prefix={folder}/input-", f"-max_len={LONGEST.get(name, 12_000)}"]
    with (folder / "log.txt").open("w") as log:
        subprocess.run(words, stdout=log, stderr=log, check=False)
    text = (folder / "log.txt").read_text(errors="replace")
    inputs = re.findall(r"number_of_executed_units: (\d+)|^#(\d+)", text, re.MULTILINE)
    reached = re.findall(r"cov: (\d+)", text)
    answers = folder / "answers.json"
    ends = json.loads(answers.read_bytes()) if answers.exists() else {}
    return Found(
        max([int(a or b) for a, b in inputs], default=0),
        f"{reached[-1]} edges" if reached else "no edges",
        ", ".join(f"{end} {count:,}" for end, count in sorted(ends.items())),
        tuple(sorted(set(folder.glob("input-*")) - before)),
    )


def main(words: list[str]) -> int:
    """Fuzz, print, and return 1 if anything stumbled."""
    parser = argparse.ArgumentParser(prog="python -m fuzz", description="Fuzz rvmon.")
    parser.add_argument("--seconds", type=int, default=60, help="in all")
    parser.add_argument("--only", nargs="+", choices=TARGETS, default=[*TARGETS])
    parser.add_argument("--out", type=Path, default=Path("out/fuzz"))
    options = parser.parse_args(words)
    if find_spec("atheris") is None:
        print("nothing is fuzzed, as atheris is not installed")
        return 1
    os.environ["RVMON_CACHE"] = "off"
    stumbled = 0
    for name in options.only:
        found = fuzz_target(name, options.out, max(1, options.seconds // len(options.only)))
        print(f"{name:12} {found.inputs:>9,} inputs, {found.places}; {found.answers}", flush=True)
        for path in found.stumbled:
            print(f"  stumbled over {path}")
        stumbled += len(found.stumbled)
    return 1 if stumbled else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
