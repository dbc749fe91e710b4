r"""Kill processes at random points: what lives on, is torn or lost, or told again otherwise?

    python -m benchmarks.endurance kills --kills 200 --only "rvmon run --resume" mqtt

Parents that have others work for them are killed by SIGKILL and by SIGTERM, in turn: how many of
their processes live 2 s later, how many files are half written or bear a name that says that they
are not finished? Runs that are kept (`rvmon watch --state`, a program with a `DurableMonitor`,
`rvmon run --resume`, shards, a campaign) are begun again after each kill until they end:
what they write is compared with what they write undisturbed. A watch of a live door, which is not
kept, must not have passed over a message in silence, or told a verdict twice. Exits 1 if something
is wrong. Needs Linux's /proc.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import random
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, suppress
from functools import partial
from pathlib import Path
from xml.etree import ElementTree

from benchmarks.endurance import killed_doors
from tests.tools import killed_watch
from tests.tools.forked import Forked

import handover.cli
from rvmon import cli
from rvmon.execute.journal import entries
from rvmon.files import SUFFIX, read_kept

PATIENCE_S = 2.0
"""Seconds that processes may take to end."""

LONGEST_S = 4.0
"""Seconds after which parents are killed at the latest."""

MARK = "RVMON_KILLS"
"""The variable by which processes are found again, whoever began them."""

ROOT = Path(__file__).resolve().parents[2]

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

_JUDGE = "rvmon run s.rv . --out out/v.csv --resume"

RESUMED = {
    "rvmon run --resume": [_JUDGE],
    "rvmon run --jobs 2 --resume": [f"{_JUDGE} --jobs 2"],
    "rvmon run --shard": [f"{_JUDGE} --shard 1/2", f"{_JUDGE} --shard 2/2", _JUDGE],
    "handover run, resumed": ["handover run --tests 40 --legacy --jobs 2 --out out"],
}
"""Commands that are ended again and again, with all that they began, until they come to an end."""

SECONDS = re.compile(rb'("seconds": ?|simulated in |\bin )[\d.]+|"spent": ?[\d.]+')


def inputs(folder: Path) -> None:
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


def _database(path: Path) -> None:
    with closing(sqlite3.connect(path)) as database:
        found = database.execute("PRAGMA integrity_check").fetchone()
    if found != ("ok",):
        raise ValueError(found)


def _journal(path: Path) -> None:
    entries(path, all_of_them=True)  # the last one may be torn: it was killed in it


READERS: dict[str, Callable[[Path], object]] = {
    ".db": _database,
    ".journal": _journal,
    ".unfinished": _journal,
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
        except (ValueError, ElementTree.ParseError, sqlite3.DatabaseError):
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


def _main(words: str) -> object:
    program, *arguments = words.split(" ")
    return {"rvmon": cli.main, "handover": handover.cli.main}[program](arguments)


def _kept(out: Path) -> int:
    """So many bytes are kept of what is not finished."""
    size = 0
    for path in out.rglob("*"):
        with suppress(FileNotFoundError):  # it is finished just now
            size += path.stat().st_size * (path.suffix in (".journal", ".unfinished"))
    return size


def resumed(commands: Sequence[str], folder: Path, kills: int, seed: int) -> Counter[str]:
    """Run commands undisturbed, then killed whenever more than before is kept; again, if need be.

    Each kill interrupts something: what was kept had grown by a random size since it was begun.
    """
    dice, found, out = random.Random(seed), Counter[str](), folder / "out"
    full = [0] * len(commands)
    known: dict[str, bytes] | None = None
    while known is None or found["kills"] < kills:
        out.mkdir()
        for place, words in enumerate(commands):
            is_over = False
            while not is_over:
                before = _kept(out)
                grown = dice.uniform(1, full[place] / 5) if known else math.inf

                def is_time(place: int = place, least: float = before + grown) -> bool:
                    now = _kept(out)
                    full[place] = max(full[place], now)
                    return now > least

                process = Forked(partial(_main, words), folder, folder / "told")
                is_over = not process.kill_when(is_time)
                found["kills"] += not is_over
                found["half written"] += sum(map(_is_half_written, _files(out)))
        known = known or _written(out)
        found["runs to the end"] += 1
        found["changed runs"] += _written(out) != known
        found["left behind"] += _kept(out) > 0
        shutil.rmtree(out)
    return found


def _judged_and_resumed(kind: str, folder: Path, kills: int, seed: int) -> Counter[str]:
    _write_recordings(folder, 100, 300, random.Random(seed))
    return resumed(RESUMED[kind], folder, kills, seed)


def _kept_watch(kind: str, folder: Path, kills: int, seed: int) -> Counter[str]:
    """Verdicts of lines, told by lives that are killed, beside those of one that is not."""
    killed_watch.written(folder, seed, 40 * kills)
    expected = killed_watch.whole(folder)
    run: Callable[[], object] = partial(cli.main, killed_watch.WATCH.split(" "))
    if kind != WATCH:
        run = partial(killed_watch.program, folder)
    found, done = killed_watch.killed(folder, kills, seed, run)
    return Counter(
        {
            "kills": done,
            "verdicts": len(expected),
            "lost": len(expected.keys() - found.keys()),
            "of nobody": len(found.keys() - expected.keys()),
            "changed": sum(found[n] != expected[n] for n in found.keys() & expected),
        }
    )


def _parents(kind: str, folder: Path, kills: int, seed: int) -> Counter[str]:
    rng = random.Random(f"{seed} {kind}")
    inputs(folder)
    trial = Trial(PARENTS[kind], folder)
    for number in range(kills):
        trial.kill(number, rng.uniform(0, trial.span))
    return trial.found


KINDS: dict[str, Callable[[str, Path, int, int], Counter[str]]] = {
    **dict.fromkeys(PARENTS, _parents),
    **dict.fromkeys(RESUMED, _judged_and_resumed),
    **dict.fromkeys((WATCH, "DurableMonitor"), _kept_watch),
    **dict.fromkeys(killed_doors.DOORS, killed_doors.killed),
}

WRONG = (
    *("survivors", "half written", "changed runs", "left behind"),
    *("lost", "of nobody", "changed", "told twice", "left out", "ended by itself"),
)
"""Ends of what must not be counted."""


def main(argv: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--kills", type=int, default=50, help="of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=KINDS, nargs="+", default=[*KINDS], metavar="KIND")
    options = parser.parse_args(argv)
    bad = 0
    for kind in options.only:
        with tempfile.TemporaryDirectory() as folder:
            found = KINDS[kind](kind, Path(folder), options.kills, options.seed)
        print(f"{kind}: {options.kills} kills", flush=True)
        for what, count in sorted(found.items()):
            print(f"  {what}: {count:,}", flush=True)
            bad += count * what.endswith(WRONG)
    return 1 if bad else 0
