"""Does the core's C hold a line that no test needs? Seeded mutants of it, run on recorded cases.

    python -m benchmarks.core_mutants --count 30 --seed 1 [--tests] [FILE …]

Of each file so many changes are drawn, evenly over their kinds. Each is compiled alone, linked with
the others, and judges the cases of `benchmarks.core_recording`, of which the law and the core say
the same (core_replay.c): it is killed if it says anything else, crashes or hangs. What does not
compile is not counted, nor what a compiler makes the same code of. With `--tests` those that
survive go through tests/rvmon/core. Prints each that survives, and the counts of each file; exits 1
if any does.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.core_recording import recorded
from benchmarks.mutants import draw
from benchmarks.mutation_c import c_mutants

from rvmon.cdv.mutation.mutant import Mutant

ROOT = Path(__file__).resolve().parent.parent
CORE = ROOT / "src" / "rvmon" / "core"
REPLAY = Path(__file__).with_name("core_replay.c")
FLAGS = ("-std=c99", "-O1", "-ffp-contract=off", "-w")
MOST_MEMORY = 2 << 30


def sources() -> list[Path]:
    """The C of the core, without the binding."""
    return sorted(path for path in CORE.glob("*.c") if path.name != "module.c")


class Trial:
    """The objects of the core, of which one after the other is replaced by that of a mutant.

    Args:
        folder: empty.
        cases: as `recorded` gives them.
    """

    def __init__(self, folder: Path, cases: bytes) -> None:
        self._folder = folder
        for header in CORE.glob("*.h"):
            shutil.copy2(header, folder)
        self._cases = folder / "cases"
        self._cases.write_bytes(cases)
        self._objects = {path: folder / f"{path.stem}.o" for path in (*sources(), REPLAY)}
        for path, made in self._objects.items():
            if not self._compiled(path, made):
                raise SystemExit(f"{path} does not compile")
        began = time.perf_counter()
        self._expected = self._said(folder / "core", list(self._objects.values()), 600.0)
        self._seconds = time.perf_counter() - began
        if self._expected is None:
            raise SystemExit("without a change, the core crashes or hangs")
        for path in sources()[:1]:
            whole = Mutant(path, 0, "", "", "", path.read_text(encoding="utf-8"))
            if self.outcome(whole) != "same":
                raise SystemExit(f"{path.name} without a change is not the same")

    def outcome(self, mutant: Mutant) -> str:
        """`killed`, `survived`, or why it does not count: `unbuilt`, `same`."""
        changed, made = self._folder / "mutant.c", self._folder / "mutant.o"
        changed.write_text(mutant.source, encoding="utf-8")
        if not self._compiled(changed, made):
            return "unbuilt"
        own = self._objects[mutant.path]
        if _code_of(made) == _code_of(own):
            return "same"
        objects = [made if one == own else one for one in self._objects.values()]
        said = self._said(self._folder / "mutated", objects, 5 + 10 * self._seconds)
        return "survived" if said == self._expected else "killed"

    def _compiled(self, source: Path, made: Path) -> bool:
        words = ["gcc", *FLAGS, f"-I{self._folder}", "-c", str(source), "-o", str(made)]
        return subprocess.run(words, capture_output=True, check=False).returncode == 0

    def _said(self, program: Path, objects: Sequence[Path], most: float) -> bytes | None:
        words = ["gcc", *map(str, objects), "-lm", "-o", str(program)]
        subprocess.run(words, check=True, capture_output=True)
        try:
            done = subprocess.run(
                [str(program), str(self._cases)],
                capture_output=True,
                timeout=most,
                check=False,
                preexec_fn=_bound_memory,
            )
        except subprocess.TimeoutExpired:
            return None
        return None if done.returncode else done.stdout


def _code_of(made: Path) -> bytes:
    """The machine code of an object, without the name of its source."""
    words = ["objdump", "-drs", "-j", ".text", "-j", ".rodata", str(made)]
    told = subprocess.run(words, capture_output=True, check=False).stdout
    return told.split(b"\n", 3)[-1]


def _bound_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def tested(mutants: Sequence[Mutant]) -> Iterator[Mutant]:
    """Those that tests/rvmon/core lets pass."""
    with tempfile.TemporaryDirectory() as directory:
        copy = Path(directory)
        ignored = shutil.ignore_patterns("__pycache__", "_core*")
        shutil.copytree(ROOT / "src", copy / "src", ignore=ignored)
        shutil.copy2(ROOT / "hatch_build.py", copy)
        path = os.pathsep.join([str(copy / "src"), str(ROOT)])
        environment = {**os.environ, "PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1"}
        tests = ["-m", "pytest", "-x", "-q", "-n", "0", "-p", "no:cacheprovider"]
        tests += ["-m", "not compiler", "tests/rvmon/core"]
        for mutant in mutants:
            place = copy / mutant.path.relative_to(ROOT)
            place.write_text(mutant.source, encoding="utf-8")
            words = [[sys.executable, str(copy / "hatch_build.py")], [sys.executable, *tests]]
            try:
                passed = all(
                    subprocess.run(
                        one,
                        cwd=ROOT,
                        env=environment,
                        capture_output=True,
                        check=False,
                        timeout=600,
                    ).returncode
                    == 0
                    for one in words
                )
            except subprocess.TimeoutExpired:
                passed = False
            shutil.copy2(mutant.path, place)
            if passed:
                yield mutant


def main(words: list[str]) -> int:
    """Draw, try and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.core_mutants")
    parser.add_argument("files", nargs="*", help="names of files of the core; default: all")
    parser.add_argument("--count", type=int, default=30, help="of each file")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--pairs", type=int, default=1_200)
    parser.add_argument(
        "--recorded",
        type=Path,
        nargs="+",
        help="cases, instead of new ones; then more for the rest",
    )
    parser.add_argument("--tests", action="store_true", help="try those left by tests/rvmon/core")
    options = parser.parse_args(words)
    cases = [path.read_bytes() for path in options.recorded or ()]
    first, *further = cases or [recorded(options.pairs, options.seed)]
    left: list[Mutant] = []
    total: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as directory:
        trial = Trial(Path(directory), first)
        for path in sources():
            if options.files and path.name not in options.files:
                continue
            found: Counter[str] = Counter()
            possible = [*c_mutants(path)]
            for mutant in draw(possible, options):
                outcome = trial.outcome(mutant)
                found[outcome] += 1
                if outcome == "survived":
                    left.append(mutant)
                    print(f"survived  {mutant}", flush=True)
            total += found
            print(f"{path.name}: {_told(found)}, of {len(possible)}", flush=True)
    print(f"all: {_told(total)}")
    for more in further:
        with tempfile.TemporaryDirectory() as directory:
            trial = Trial(Path(directory), more)
            left = [mutant for mutant in left if trial.outcome(mutant) == "survived"]
        for mutant in left:
            print(f"survived more  {mutant}", flush=True)
        print(f"{len(left)} survived more cases", flush=True)
    if options.tests:
        left = [*tested(left)]
        for mutant in left:
            print(f"tests let pass  {mutant}")
        print(f"tests/rvmon/core lets {len(left)} pass")
    return 1 if left else 0


def _told(found: Counter[str]) -> str:
    counted = found["killed"] + found["survived"]
    return (
        f"{found['killed']} of {counted} killed, {found['same']} same, {found['unbuilt']} unbuilt"
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
