"""Does the differential test see wrong engines? Seeded mutants of their source, run against it.

    python -m benchmarks.mutants --engine python --count 30 --seed 1

Changes are drawn evenly over their kinds, from the lines of the engine's files that the test
executes (of C, from all lines). Each is tried in a copy of the package. A mutant is killed if the
test finds a disagreement, hangs or breaks, or if the engine refuses other specifications than it
did; one that survives is tried again with 10,000 pairs, then with the engines that have its
files in common. Those listed in `EQUIVALENT` change
no behaviour, for the reason given there; others are drawn in their place. Exits 1 if one survives.
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
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from benchmarks.engines import ENGINES, PACKAGE, RELATED, files_of
from benchmarks.equivalent import EQUIVALENT
from benchmarks.mutation import Mutant, mutants
from benchmarks.mutation_c import c_mutants

ROOT = Path(__file__).resolve().parent.parent

MOST_MEMORY = 4 << 30
THOROUGH = 10_000
"""Pairs of the second try."""

MORE = 4
"""Times the pairs of the first try: for the engines that are tried last."""


def main(argv: Sequence[str]) -> int:
    """Draw, run and judge the mutants."""
    options = _parse(argv)
    paths = [file for path in options.paths for file in _python_files(Path(path))]
    files = paths or files_of(options.engine)
    changes = [m for m in _changes(files, options) if options.only in m.change]
    drawn = draw((m for m in changes if m.change not in EQUIVALENT), options)
    with tempfile.TemporaryDirectory() as directory:
        trial = Trial(Path(directory), options)
        killed = sum([trial.kills(mutant) for mutant in drawn])
    passed_over = len({m.change for m in changes} & EQUIVALENT.keys())
    print(
        f"engine {options.engine}, seed {options.seed}: {len(drawn)} mutants of {len(changes)} in "
        f"{len(files)} files, {killed} killed, {len(drawn) - killed} survived; "
        f"{passed_over} known to be equivalent were not drawn"
    )
    return 0 if killed == len(drawn) else 1


def _parse(argv: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("paths", nargs="*", help="files or folders; default: those of the engine")
    parser.add_argument("--only", default="", help="changes that contain this text")
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--pairs", type=int, default=1_000)
    parser.add_argument("--engine", choices=ENGINES, default="automaton")
    parser.add_argument("--time", choices=("held", "sampled", "clocked"))
    parser.add_argument("--without", nargs="*", default=[], metavar="FEATURE")
    return parser.parse_args(argv)


def _python_files(path: Path) -> list[Path]:
    return [file.resolve() for file in (sorted(path.rglob("*.py")) if path.is_dir() else [path])]


def _command(options: argparse.Namespace, engine: str, pairs: int) -> list[str]:
    command = ["-m", "benchmarks.differential", "--fail-fast", "--online-every", "3"]
    command += ["--traces", "4", "--pairs", str(pairs), "--seed", str(options.seed)]
    command += ["--engine", engine]
    if options.time:
        command += ["--time", options.time]
    if options.without:
        command += ["--without", *options.without]
    return command


def _changes(files: Sequence[Path], options: argparse.Namespace) -> Iterator[Mutant]:
    executed = _executed_lines([file for file in files if file.suffix == ".py"], options)
    for file in files:
        yield from mutants(file, executed[file]) if file in executed else c_mutants(file)


def _executed_lines(files: Sequence[Path], options: argparse.Namespace) -> dict[Path, set[int]]:
    """The lines that the differential test executes in each file."""
    from coverage import CoverageData

    with tempfile.TemporaryDirectory() as directory:
        data = Path(directory) / "coverage"
        run = [
            "-m",
            "coverage",
            "run",
            f"--data-file={data}",
            *_command(options, options.engine, options.pairs),
        ]
        subprocess.run(
            [sys.executable, *run],
            cwd=ROOT,
            env=_environment(Path(directory), ROOT / "src"),
            check=True,
            capture_output=True,
        )
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


class Trial:
    """A copy of the package in which one mutant after the other is tried.

    Args:
        scratch: an empty folder.
        options: of the command line.
    """

    def __init__(self, scratch: Path, options: argparse.Namespace) -> None:
        self.options = options
        self.package = scratch / "src" / "rvmon"
        self.environment = _environment(scratch, scratch / "src")
        shutil.copytree(PACKAGE, self.package, ignore=shutil.ignore_patterns("__pycache__"))
        self.stages = [(options.engine, options.pairs), (options.engine, THOROUGH)]
        self.stages += [
            (engine, MORE * options.pairs) for engine in RELATED.get(options.engine, ())
        ]
        self.known: dict[tuple[str, int], tuple[str, float]] = {}

    def _as_it_is(self, engine: str, pairs: int) -> tuple[str, float]:
        """What an engine refuses without a change, and how many seconds the test takes."""
        key = (engine, pairs)
        if key not in self.known:
            began = time.perf_counter()
            verdict, refused = self._run(engine, pairs, 3_600)
            self.known[key] = refused, time.perf_counter() - began
            if verdict != "survived":
                sys.exit(f"the engine {engine} as it is does not pass the test: {verdict}")
        return self.known[key]

    def kills(self, mutant: Mutant) -> bool:
        """Try a mutant, and print what became of it."""
        place = self.package / mutant.path.relative_to(PACKAGE)
        verdict = "survived"
        for engine, pairs in self.stages:
            wanted, seconds = self._as_it_is(engine, pairs)
            place.write_text(mutant.source, encoding="utf-8")
            verdict, refused = self._run(engine, pairs, 10 + 5 * seconds)
            shutil.copy2(mutant.path, place)
            if verdict == "survived" and refused != wanted:
                verdict = "refuses"
            if verdict != "survived":
                break
        print(f"{verdict:9}  {mutant}", flush=True)
        return verdict != "survived"

    def _run(self, engine: str, pairs: int, most: float) -> tuple[str, str]:
        """The test on the copy: `survived`, `killed` or `hung`; how many specs were refused."""
        try:
            done = subprocess.run(
                [sys.executable, *_command(self.options, engine, pairs)],
                cwd=ROOT,
                env=self.environment,
                check=False,
                capture_output=True,
                text=True,
                timeout=most,
                preexec_fn=_bound_memory,
            )
        except subprocess.TimeoutExpired:
            return "hung", ""
        refused = [line for line in done.stdout.splitlines() if line.startswith("refused")]
        return "killed" if done.returncode else "survived", "".join(refused)


def _environment(scratch: Path, source: Path) -> dict[str, str]:
    """The environment of a test; compiled C is kept in the scratch folder, not made fast."""
    compiler = scratch / "cc"
    compiler.write_text('#!/bin/sh\nexec gcc "$@" -O0\n')
    compiler.chmod(0o755)
    return {
        **os.environ,
        "CC": str(compiler),
        "XDG_CACHE_HOME": str(scratch / "cache"),
        "PYTHONPATH": f"{source}{os.pathsep}{ROOT}",
        "PYTHONDONTWRITEBYTECODE": "1",
    }


def _bound_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
