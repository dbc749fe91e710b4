r"""Kill processes that have others work for them, at random instants: what lives on or is torn?

    python -m benchmarks.kills --kills 50 --seed 1

Each kind of parent is killed so often by SIGKILL and by SIGTERM, in turn. Prints how many of its
processes live 2 s later, how many files are half written, how many bear a name that says that they
are not finished, and how the parents ended. `rvmon watch --state`, `rvmon run --resume` and a
campaign are begun again after each kill, until they come to an end: what they write is compared
with what they write undisturbed, but for the seconds that it took. Exits 1 if something lives, is
half written, lost or changed. Needs Linux's /proc.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from xml.etree import ElementTree

from tests.tools import killed_watch

from rvmon.cache import read_kept
from rvmon.writing import SUFFIX

PATIENCE_S = 2.0
"""Seconds that processes may take to end."""

LONGEST_S = 4.0
"""Seconds after which parents are killed at the latest."""

MARK = "RVMON_KILLS"
"""The variable by which processes are found again, whoever began them."""

ROOT = Path(__file__).resolve().parent.parent

SPEC = """spec kills
signal p : bool
event e
"""


PARENTS = {
    "rvmon run --jobs": "rvmon run s.rv t.csv t.csv t.csv t.csv t.csv t.csv --jobs 2",
    "rvmon run --report": "rvmon run s.rv few.csv --report out",
    "rvmon run": "rvmon run s.rv many.csv --format json",
    "handover run": "handover.cli run --tests 16 --jobs 2 --out out",
    "differential": "benchmarks.differential verdicts --count 4000 --jobs 2",
}
"""Modules with arguments that begin other processes, in a folder with the inputs."""

WATCH = "rvmon watch --state"
"""It is killed again and again until it has judged its lines."""

RESUMED = {
    "rvmon run --resume": "rvmon run s.rv . --jobs 2 --resume --out out/v.csv",
    "handover run, resumed": "handover.cli run --tests 40 --legacy --jobs 2 --out out",
}
"""Ended again and again, with all that they began, until they come to an end."""

SECONDS = re.compile(rb'("seconds": ?|simulated in |\bin )[\d.]+|"spent": ?[\d.]+')


def inputs(folder: Path) -> None:
    """Write the specification and the recordings."""
    rules = (f"requirement R{n}\n  upon e then within {n} s p\n" for n in range(1, 9))
    (folder / "s.rv").write_text(SPEC + "".join(rules))
    for name, rows in (("few.csv", 300), ("t.csv", 20_000), ("many.csv", 1_500_000)):
        with (folder / name).open("w") as file:
            file.write("t,p,e\n")
            file.writelines(f"{k / 100:.2f},{k // 3 % 2},{int(k % 9 == 0)}\n" for k in range(rows))


def _words(parent: str) -> list[str]:
    return [sys.executable, "-m", *parent.split(" ")]


class Trial:
    """One folder in which parents of one kind are killed.

    Args:
        parent: its module with arguments.
        folder: with the inputs.
    """

    def __init__(self, parent: str, folder: Path) -> None:
        self.words = _words(parent)
        self.folder = folder
        began = time.perf_counter()
        self.begun(folder / "cache", "first").wait()
        self.begun(folder / "cache", "first").wait()
        self.span = min((time.perf_counter() - began) / 2, LONGEST_S)
        self.found: Counter[str] = Counter()

    def begun(self, cache: Path, mark: str) -> subprocess.Popen[bytes]:
        """A parent at work."""
        (self.folder / "out").mkdir(exist_ok=True)
        environment = {
            **os.environ,
            "XDG_CACHE_HOME": str(cache),
            "PYTHONPATH": f"{ROOT / 'src'}{os.pathsep}{ROOT}",
            MARK: mark,
        }
        return subprocess.Popen(
            self.words,
            cwd=self.folder,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def kill(self, number: int, after: float) -> None:
        """Begin a parent, kill it so many seconds later, and see what is left."""
        mark = f"{os.getpid()}-{number}"
        cache = self.folder / "cache"
        process = self.begun(cache, mark)
        time.sleep(after)
        kind = (signal.SIGKILL, signal.SIGTERM)[number % 2]
        process.send_signal(kind)
        end = time.monotonic() + PATIENCE_S
        while (living := [*_marked(mark)]) and time.monotonic() < end:
            process.poll()
            time.sleep(0.05)
        self.found[f"{kind.name} survivors"] += len(living)
        for pid in living:
            os.kill(pid, signal.SIGKILL)
        self.found[f"{kind.name} ended with {process.wait()}"] += 1
        self.found["half written"] += sum(map(_is_half_written, _files(self.folder / "out")))
        self.found["half written"] += sum(map(_is_half_written, _files(cache)))
        unfinished = [*self.folder.joinpath("out").rglob(f"*{SUFFIX}"), *cache.rglob(f"*{SUFFIX}")]
        self.found[f"{kind.name} unfinished left"] += len(unfinished)
        for path in unfinished:
            shutil.rmtree(path) if path.is_dir() else path.unlink()


def _marked(mark: str) -> Iterator[int]:
    """The processes with a mark that have not ended."""
    wanted = f"{MARK}={mark}\0".encode()
    for place in Path("/proc").glob("[0-9]*"):
        try:
            if wanted in (place / "environ").read_bytes():  # empty, once it has ended
                yield int(place.name)
        except OSError:
            continue


def _files(folder: Path) -> Iterator[Path]:
    finished = (path for path in folder.rglob("*") if SUFFIX not in str(path))
    return (path for path in finished if path.is_file())


def _lines(path: Path) -> None:
    for line in path.read_text().splitlines():
        json.loads(line)


READERS: dict[str, Callable[[Path], object]] = {
    ".json": lambda path: json.loads(path.read_bytes()),
    ".jsonl": _lines,
    ".xml": ElementTree.parse,
}


def _is_half_written(path: Path) -> bool:
    body = path.read_bytes()
    if path.parent.name == "rvmon":  # a cache, with a file that is empty
        if not path.suffix:
            return bool(body)
        return read_kept(path) is None
    if path.suffix in READERS:
        try:
            READERS[path.suffix](path)
        except (ValueError, ElementTree.ParseError):
            return True
        return not body
    if path.suffix == ".html":
        return not body.rstrip().endswith(b"</html>")
    return not body.endswith(b"\n")


RESUMED_SPEC = """spec resumed
signal x : real
requirement R1
  always (x > 1 -> eventually[0, 50 s] x < -1)
"""


def _write_recordings(folder: Path, count: int, rows: int, dice: random.Random) -> None:
    (folder / "s.rv").write_text(RESUMED_SPEC)
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


def _resumed(words: list[str], folder: Path, kills: int, dice: random.Random) -> str:
    """Run a command undisturbed, then another way to the same; what is to be told."""
    out = folder / "out"
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


def main(argv: Sequence[str]) -> int:
    """Kill, count and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--kills", type=int, default=50, help="of each kind of parent")
    parser.add_argument("--seed", type=int, default=1)
    labels = [*PARENTS, *RESUMED, WATCH]
    parser.add_argument("--only", choices=labels, nargs="+", default=labels, metavar="KIND")
    options = parser.parse_args(argv)
    bad = 0
    for label, parent in PARENTS.items():
        if label not in options.only:
            continue
        rng = random.Random(f"{options.seed} {label}")
        with tempfile.TemporaryDirectory() as folder:
            inputs(Path(folder))
            trial = Trial(parent, Path(folder))
            for number in range(options.kills):
                trial.kill(number, rng.uniform(0, trial.span))
        print(f"{label}: {options.kills} kills within {trial.span:.1f} s", flush=True)
        for what, count in sorted(trial.found.items()):
            print(f"  {what}: {count}", flush=True)
            bad += count * what.endswith(("survivors", "half written"))
    for what in RESUMED:
        if what not in options.only:
            continue
        dice = random.Random(options.seed)
        with tempfile.TemporaryDirectory() as name:
            out = Path(name) / "out"
            out.mkdir()
            _write_recordings(Path(name), 200, 2000, dice)
            told = _resumed(_words(RESUMED[what]), Path(name), options.kills, dice)
        bad += "DIFFERS" in told
        print(f"{what}: {told}", flush=True)
    if WATCH in options.only:
        with tempfile.TemporaryDirectory() as folder:
            killed_watch.written(Path(folder), options.seed, 40 * options.kills)
            expected = killed_watch.whole(Path(folder))
            found, done = killed_watch.killed(Path(folder), options.kills, options.seed)
        lost, other = expected.keys() - found.keys(), found.keys() - expected.keys()
        changed = sum(found[number] != expected[number] for number in found.keys() & expected)
        print(f"{WATCH}: {done} kills, {len(expected):,} verdicts")
        print(f"  lost: {len(lost)}, changed: {changed}, of nobody: {len(other)}")
        bad += len(lost) + changed + len(other)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
