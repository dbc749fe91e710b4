"""Does the differential test see wrong engines? Seeded mutants of their source, run against it.

    python -m benchmarks.mutants --engine python --count 30 --seed 1

Changes are drawn evenly over their kinds, from the lines of the engine's files that the test
executes (of C, from all lines). Each is tried in a copy of the package; the core is built anew if
its C was changed. A mutant is killed if the
test finds a disagreement, hangs or breaks, or if the engine refuses other specifications than it
did. A few pairs find most of them; one that survives is tried again with all, with samples in
portions and with snapshots, with 10,000 pairs, with the engines that have its files in common, then
by the tests of their packages. Those listed in `EQUIVALENT` change no behaviour, for the reason
given there; others are drawn in their place. Exits 1 if one survives.
"""

from __future__ import annotations

import argparse
import compileall
import itertools
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.engines import COLUMNS, ENGINES, PACKAGE, RELATED, files_of
from benchmarks.equivalent import EQUIVALENT
from benchmarks.mutation_c import c_mutants
from tests.tools.forms import EXPLAINING as SWITCHABLE
from tests.tools.ways import INTERRUPT, NEXT

from rvmon.cdv.mutation.mutant import Mutant
from rvmon.cdv.mutation.source import mutants
from rvmon.execute.command import run
from rvmon.execute.interrupt import interrupted_by_sigterm

ROOT = Path(__file__).resolve().parent.parent

MOST_MEMORY = 4 << 30
THOROUGH = 10_000
"""Pairs of the second try."""

LAWS = "tests/rvmon/laws"
"""What holds of all engines is tested there."""

KINDS = (
    *("comparison", "and/or", "dropped operand", "dropped not", "off by one", "operator"),
    *("constant", "swapped branches", "negated condition", "function", "dropped statement"),
)
"""The changes of Python code that are tried."""

MORE = 4
"""Times the pairs of the first try: for the engines that are tried last."""


def main(argv: Sequence[str]) -> int:
    """Draw, run and judge the mutants."""
    options = _parse(argv)
    paths = [file for path in options.paths for file in _python_files(Path(path))]
    files = paths or files_of(options.engine)
    changes = [m for m in _changes(files, options) if options.only in m.change]
    drawn = draw((m for m in changes if m.change not in EQUIVALENT), options)
    with interrupted_by_sigterm(), tempfile.TemporaryDirectory() as directory:
        trial = Trial(Path(directory), options)
        left = drawn
        for stage in stages_of(options.engine, files, options.pairs)[: options.stages]:
            if left:
                print(f"{len(left)} go through {stage}", flush=True)
            left = [mutant for mutant in left if not trial.kills(mutant, stage)]
    for mutant in left:
        print(f"survived  {mutant}")
    killed = len(drawn) - len(left)
    passed_over = len({m.change for m in changes} & EQUIVALENT.keys())
    print(
        f"engine {options.engine}, seed {options.seed}: {len(drawn)} mutants of {len(changes)} in "
        f"{len(files)} files, {killed} killed, {len(left)} survived; "
        f"{passed_over} known to be equivalent were not drawn"
    )
    return 1 if left else 0


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
    parser.add_argument("--stages", type=int, help="only the first so many tries")
    parser.add_argument("--since", metavar="REVISION", help="only in lines that are newer")
    return parser.parse_args(argv)


def _python_files(path: Path) -> list[Path]:
    return [file.resolve() for file in (sorted(path.rglob("*.py")) if path.is_dir() else [path])]


def _command(options: argparse.Namespace, stage: Stage | Tests) -> list[str]:
    if isinstance(stage, Tests):
        return ["-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *stage.folders]
    drawn = ["--pairs", str(stage.pairs), "--seed", str(options.seed)]
    if options.time:
        drawn += ["--time", options.time]
    if stage.engines == (COLUMNS,):
        return ["-m", "benchmarks.columns", "--fail-fast", *drawn]
    if options.without:
        drawn += ["--without", *options.without]
    command = ["-m", "benchmarks.differential", "--fail-fast", "--online-every", "3"]
    return [*command, "--traces", "4", *drawn, "--engine", *stage.engines]


@dataclass(frozen=True, slots=True)
class Stage:
    """One try: so many pairs of the differential test, on some engines together."""

    engines: tuple[str, ...]
    pairs: int

    def __str__(self) -> str:
        return f"{self.pairs} pairs of {' '.join(self.engines)}"


@dataclass(frozen=True, slots=True)
class Tests:
    """One try: the tests in some folders."""

    folders: tuple[str, ...]

    def __str__(self) -> str:
        return " ".join(self.folders)


def stages_of(engine: str, files: Sequence[Path], pairs: int) -> list[Stage | Tests]:
    """What a mutant of an engine, which consists of `files`, goes through until it is killed."""
    stages: list[Stage | Tests] = [Stage((engine,), pairs // 10), Stage((engine,), pairs)]
    if engine in SWITCHABLE:
        stages.append(Stage((f"{engine}+{NEXT}", f"{engine}+{INTERRUPT}"), pairs))
    stages.append(Stage((engine,), THOROUGH))
    if related := RELATED.get(engine, ()):
        stages.append(Stage(related, MORE * pairs))
    return [*stages, Tests((*_tests_of(files), LAWS))]


def _tests_of(files: Iterable[Path]) -> list[str]:
    """The folders of the tests of the packages that have the files."""
    packages = {file.relative_to(PACKAGE).parts[0] for file in files}
    return [f"tests/rvmon/{package}" for package in sorted(packages)]


def _changes(files: Sequence[Path], options: argparse.Namespace) -> Iterator[Mutant]:
    executed = _executed_lines([file for file in files if file.suffix == ".py"], options)
    newer = None if options.since is None else _newer_lines(options.since)
    for file in files:
        python = file in executed
        for mutant in mutants(file, executed[file], KINDS) if python else c_mutants(file):
            if newer is None or mutant.line in newer.get(file, ()):
                yield mutant


def _newer_lines(revision: str) -> dict[Path, set[int]]:
    """The lines of the package that are not as they were then; what was moved is recognised."""
    command = ["git", "diff", "--unified=0", "--find-renames", revision, "--", str(PACKAGE)]
    told = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    gone = {line[1:].strip() for line in told.splitlines() if re.match("-(?!-- )", line)}
    found: dict[Path, set[int]] = {}
    lines: set[int] = set()
    number = 0
    for line in told.splitlines():
        if name := re.match(r"\+\+\+ b/(.+)", line):
            lines = found.setdefault(ROOT / name[1], set())
        elif hunk := re.match(r"@@ -\S+ \+(\d+)", line):
            number = int(hunk[1])
        elif line.startswith("+"):
            if line[1:].strip() not in gone:
                lines.add(number)
            number += 1
    return found


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
            f"--include={','.join(map(str, files))}",
            *_command(options, Stage((options.engine,), options.pairs)),
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
    """A seeded sample, the kinds of change in turn; what is drawn depends on no other mutant."""
    kinds: dict[str, list[Mutant]] = {}
    for mutant in found:
        kinds.setdefault(mutant.kind, []).append(mutant)
    for members in kinds.values():
        members.sort(key=lambda mutant: random.Random(f"{options.seed} {mutant.change}").random())
    rounds = itertools.chain.from_iterable(itertools.zip_longest(*kinds.values()))
    return [*itertools.islice(filter(None, rounds), options.count)]


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
        self.build = Path(shutil.copy2(ROOT / "hatch_build.py", scratch))
        # A changed file is newer than what was compiled, and what is compiled then is not kept.
        compileall.compile_dir(self.package, quiet=2)
        self.known: dict[Stage | Tests, tuple[list[str], float]] = {}

    def _as_it_is(self, stage: Stage | Tests) -> tuple[list[str], float]:
        """What engines refuse without a change, and how many seconds the test takes."""
        if stage not in self.known:
            began = time.perf_counter()
            verdict, refused = self._run(stage, 3_600)
            self.known[stage] = refused, time.perf_counter() - began
            if verdict != "survived":
                sys.exit(f"without a change, {stage} do not pass the test: {verdict}")
        return self.known[stage]

    def kills(self, mutant: Mutant, stage: Stage | Tests) -> bool:
        """Try a mutant; if it does not survive, print what became of it."""
        wanted, seconds = self._as_it_is(stage)
        place = self.package / mutant.path.relative_to(PACKAGE)
        place.write_text(mutant.source, encoding="utf-8")
        verdict, refused = "unbuilt", wanted
        if mutant.path.suffix == ".py" or self._is_built():
            verdict, refused = self._run(stage, 10 + 5 * seconds)
        shutil.copy2(mutant.path, place)
        for built in (PACKAGE / "core").glob("_core*.*so"):
            shutil.copy2(built, self.package / "core")
        if verdict == "survived" and refused != wanted:
            verdict = "refuses"
        if verdict != "survived":
            print(f"{verdict:9} {mutant}", flush=True)
        return verdict != "survived"

    def _is_built(self) -> bool:
        """Build the core of the copy; false if a compiler refuses it."""
        done = run([sys.executable, str(self.build)], cwd=ROOT, env=self.environment)
        return done.returncode == 0

    def _run(self, stage: Stage | Tests, most: float) -> tuple[str, list[str]]:
        """The test on the copy: `survived`, `killed` or `hung`; how many specs were refused."""
        try:
            done = run(
                [sys.executable, *_command(self.options, stage)],
                cwd=ROOT,
                env=self.environment,
                timeout=most,
                preexec_fn=_bound_memory,
            )
        except subprocess.TimeoutExpired:
            return "hung", []
        refused = re.findall(r"refused \d+", done.stdout)
        return "killed" if done.returncode else "survived", refused


def _environment(scratch: Path, source: Path) -> dict[str, str]:
    """The environment of a test."""
    return {
        **os.environ,
        "XDG_CACHE_HOME": str(scratch / "cache"),
        "PYTHONPATH": f"{source}{os.pathsep}{ROOT}",
        "PYTHONDONTWRITEBYTECODE": "1",
    }


def _bound_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
