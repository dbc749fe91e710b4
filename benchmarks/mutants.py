"""Does the differential test see wrong engines? Seeded mutants of their source, run against it.

    python -m benchmarks.mutants src/rvmon/automaton src/rvmon/monitor --count 30 --seed 1

Changes are drawn evenly over their kinds, from the lines that the test executes. Each is tried in
a copy of the package. A mutant is killed if the test finds a disagreement, hangs or breaks; one
that survives is tried again with five times the pairs. Those listed in `EQUIVALENT` change no
behaviour, for the reason given there. Exits 1 if another one survives.
"""

from __future__ import annotations

import argparse
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Sequence
from pathlib import Path

from benchmarks.mutation import Mutant, mutants

ROOT = Path(__file__).resolve().parent.parent

EQUIVALENT = {
    "stretch.py off by one: `position - 1` => `position`": (
        "time passes up to the position before its letter is read, here or in the step itself"
    ),
    "factory.py dropped statement: `flat.pop(unit, None)` => `pass`": (
        "`true and x` is only not made smaller; it still means x"
    ),
    "lower.py and/or: `interval and interval.high` => `interval or interval.high`": (
        "`held` always has an interval"
    ),
    "lane.py dropped statement: `self._pass_to(min(position - 1, limit))` => `pass`": (
        "a visit, and `reach`, let time pass to the instant before by themselves"
    ),
    "construct.py off by one: `entered[clock] + 1` => `entered[clock]`": (
        "another age of the same region, or a row for one in which no step can happen"
    ),
}
"""Changes that no test could see, with the reason."""

TELLS_ONLY = ("explain.py", "wording.py", "health.py")
"""Files that make sentences and input health: the differential test compares neither."""

MOST_MEMORY = 4 << 30
MORE = 5


def main(argv: Sequence[str]) -> int:
    """Draw, run and judge the mutants."""
    options = _parse(argv)
    files = [file for path in options.paths for file in _python_files(Path(path))]
    executed = _executed_lines(files, options)
    found = (m for f in files for m in mutants(f, executed.get(f, set())))
    drawn = draw((m for m in found if options.only in m.change), options)
    with tempfile.TemporaryDirectory() as directory:
        package = Path(directory) / "src" / "rvmon"
        shutil.copytree(ROOT / "src" / "rvmon", package)
        began = time.perf_counter()
        if (verdict := _run(package, options, options.pairs, 3_600)) != "survived":
            sys.exit(f"the engine as it is does not pass the test: {verdict}")
        seconds = time.perf_counter() - began
        survivors = [m for m in drawn if not _killed(m, package, options, seconds)]
    equivalent = [mutant for mutant in survivors if mutant.change in EQUIVALENT]
    killed = len(drawn) - len(survivors)
    print(f"{len(drawn)} mutants: {killed} killed, {len(equivalent)} equivalent, ", end="")
    print(f"{len(survivors) - len(equivalent)} survived")
    return 1 if len(survivors) > len(equivalent) else 0


def _parse(argv: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("paths", nargs="+", help="files or folders of the engine")
    parser.add_argument("--only", default="", help="changes that contain this text")
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--pairs", type=int, default=1_000)
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--time", choices=("held", "sampled", "clocked"))
    parser.add_argument("--without", nargs="*", default=[], metavar="FEATURE")
    return parser.parse_args(argv)


def _python_files(path: Path) -> list[Path]:
    found = sorted(path.rglob("*.py")) if path.is_dir() else [path]
    return [file.resolve() for file in found if file.name not in TELLS_ONLY]


def _command(options: argparse.Namespace, pairs: int) -> list[str]:
    command = ["-m", "benchmarks.differential", "--fail-fast", "--online-every", "3"]
    command += ["--pairs", str(pairs), "--seed", str(options.seed), "--engine", options.engine]
    if options.time:
        command += ["--time", options.time]
    if options.without:
        command += ["--without", *options.without]
    return command


def _executed_lines(files: Iterable[Path], options: argparse.Namespace) -> dict[Path, set[int]]:
    """The lines that the differential test executes in each file."""
    from coverage import CoverageData

    with tempfile.TemporaryDirectory() as directory:
        data = Path(directory) / "coverage"
        run = ["-m", "coverage", "run", f"--data-file={data}", *_command(options, options.pairs)]
        subprocess.run([sys.executable, *run], cwd=ROOT, check=True, capture_output=True)
        collected = CoverageData(str(data))
        collected.read()
        return {file: set(collected.lines(str(file)) or ()) for file in files}


def draw(found: Iterable[Mutant], options: argparse.Namespace) -> list[Mutant]:
    """A seeded sample, the kinds of change in turn."""
    dice = random.Random(options.seed)
    kinds: dict[str, list[Mutant]] = {}
    for mutant in found:
        kinds.setdefault(mutant.kind, []).append(mutant)
    for members in kinds.values():
        dice.shuffle(members)
    chosen: list[Mutant] = []
    while len(chosen) < options.count and any(kinds.values()):
        for members in kinds.values():
            if members and len(chosen) < options.count:
                chosen.append(members.pop())
    return chosen


def _killed(mutant: Mutant, package: Path, options: argparse.Namespace, seconds: float) -> bool:
    """Try one mutant in the copy of the package, and print what became of it."""
    place = package / mutant.path.relative_to(ROOT / "src" / "rvmon")
    place.write_text(mutant.source, encoding="utf-8")
    try:
        verdict = _run(package, options, options.pairs, 10 + 5 * seconds)
        if verdict == "survived":
            verdict = _run(package, options, MORE * options.pairs, 10 + 5 * MORE * seconds)
    finally:
        shutil.copy2(mutant.path, place)
    reason = EQUIVALENT.get(mutant.change) if verdict == "survived" else None
    print(f"{'equivalent: ' + reason if reason else verdict:9}  {mutant}", flush=True)
    return verdict != "survived"


def _run(package: Path, options: argparse.Namespace, pairs: int, most: float) -> str:
    """The differential test on the copy: `survived`, `killed` or `hung`."""
    environment = {
        **os.environ,
        "PYTHONPATH": f"{package.parent}{os.pathsep}{ROOT}",
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    try:
        done = subprocess.run(
            [sys.executable, *_command(options, pairs)],
            cwd=ROOT,
            env=environment,
            check=False,
            capture_output=True,
            timeout=most,
            preexec_fn=_bound_memory,
        )
    except subprocess.TimeoutExpired:
        return "hung"
    return "killed" if done.returncode else "survived"


def _bound_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
