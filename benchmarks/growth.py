"""How cost grows with the work, and what large and endless inputs cost.

    python -m benchmarks.growth scale --recordings 10000 --requirements 10000 --tests 1000
    python -m benchmarks.growth large [--only WORD] [--limit SECONDS]
    python -m benchmarks.growth coverage [--tests 10000] [--items 1000] [--share 0.2]

`scale` multiplies the number of recordings, requirements and tests by ten, up to those given: what
one of them costs more than at a tenth of them. `large` has inputs that are wide, nested, endless or
all decided at once; a process that needs longer than the limit is stopped, and none may take more
than 6 GiB. `coverage` records tests that hit a random share of the items, with random counts and
instants (real ones repeat, and take less room), and looks at the database.

Each is done by a process of its own: seconds of the clock and of CPU (with those of all processes
that it began), largest resident memory, exit code, and the last line that was said.
"""

from __future__ import annotations

import argparse
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from rvmon.coverage.database import Database
from rvmon.coverage.model import Hit, Hits, Item, Subject, group_of, model_of
from rvmon.coverage.record import TestRecord

ROWS = 100
"""Of a recording."""

SPEC = "spec s\nsignal p, q : bool\nsignal x : real\nrequirement R1\n  always x < 3\n"
MOST_MEMORY = 6 << 30

GROUPS = 10
DIFFERENT = 100
"""Hits that are drawn ahead, so that drawing them is not measured; tests take them in turn."""

OPEN_ATTEMPTS = """
import time, rvmon
monitor = rvmon.loads('''spec s
signal p : bool
event e
requirement R1
  upon e
  then within 100000 s p
''').monitor()
for t in range(1_000_000):
    monitor.step_ns(t, {"p": False, "e": True})
begun = time.process_time()
decided = monitor.step_ns(1_000_000, {"p": True})
print(f"{len(decided):,} attempts decided in {time.process_time() - begun:.2f} s")
"""
"""All that is open is decided by one step."""

OPEN_INSTANCES = """
import gc, time, rvmon
monitor = rvmon.loads('''spec s
event req(id: int)
event done(id: int)
requirement R1
  upon req.id == k
  then within 50000 s done.id == k
  for each k in req.id
''').monitor()
pauses, begun = [0.0], []
def pause(phase, _):
    if phase == "start":
        begun.append(time.process_time())
    else:
        pauses.append(time.process_time() - begun.pop())
gc.callbacks.append(pause)
def stepped(t, values):
    first = time.process_time()
    monitor.step_ns(t * 1_000_000_000, values)
    return time.process_time() - first
took = [stepped(t, {"req": {"id": t}}) for t in range(20_000)]
print(f"{sum(took):.1f} s, the longest {max(took):.2f} s", end=", ")
print(f"the collector's {max(pauses):.2f} s", end="; ")
print(f"all decided in {stepped(1_000_000, {}):.2f} s")
"""
"""Instances of `for each` are opened one by one, then time decides all at once."""


COUNTERS = """
int[0, 1000000000] a, b
automaton counting {
  clock x
  location going invariant x <= 1
  start going
  edge going -> going when x >= 1 do x = 0, a = a + 1
}
query far: E<> a == 1000000000
"""


class Cost(NamedTuple):
    """What one process cost, and how it ended."""

    seconds: float
    cpu: float
    mebibytes: float
    code: int
    said: str


def shown(title: str, cost: Cost, more: str = "") -> None:
    """Print a row of the table."""
    said = more or (cost.said if len(cost.said) <= 60 else cost.said[:59] + "…")
    figures = f"{cost.seconds:8.2f}{cost.cpu:8.2f}{cost.mebibytes:8.0f}{cost.code:6}"
    print(f"{title:44}{figures}  {said}", flush=True)


def measured(command: Sequence[str], limit: float) -> Cost:
    """Run one process, at most so many seconds."""

    def bounded() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))

    begun, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(
            command, stdout=output, stderr=output, preexec_fn=bounded, start_new_session=True
        )
        signal.signal(signal.SIGALRM, lambda *_: os.killpg(process.pid, signal.SIGKILL))
        signal.setitimer(signal.ITIMER_REAL, limit)
        _, status, usage = os.wait4(process.pid, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        seconds = time.monotonic() - begun
        output.seek(0)
        lines = output.read()[-4000:].decode(errors="replace").strip().splitlines()
    process.returncode = os.waitstatus_to_exitcode(status)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    said = lines[-1] if lines else ""
    return Cost(seconds, cpu, usage.ru_maxrss / 1024, process.returncode, said)


def scale(options: argparse.Namespace) -> None:
    """Recordings, requirements, tests, ten times as many each time."""
    dice = random.Random(1)

    def recordings(folder: Path, count: int) -> list[str]:
        (folder / "s.rv").write_text(_requirements(10))
        (folder / "data").mkdir()
        text = _recording(dice)
        for number in range(count):
            (folder / "data" / f"{number:06}.csv").write_text(text)
        out = str(folder / "v.csv")
        return [
            *rvmon("run"),
            str(folder / "s.rv"),
            str(folder / "data"),
            "--jobs",
            "2",
            "--out",
            out,
        ]

    def requirements(folder: Path, count: int) -> list[str]:
        (folder / "s.rv").write_text(_requirements(count))
        (folder / "r.csv").write_text(_recording(dice))
        return [*rvmon("run"), str(folder / "s.rv"), str(folder / "r.csv"), "--quiet"]

    def tests(folder: Path, count: int) -> list[str]:
        words = ["-m", "handover.cli", "run", "--strategy", "constrained", "--tests", str(count)]
        return [sys.executable, *words, "--legacy", "--out", str(folder / "out")]

    for work in (recordings, requirements, tests):
        most, last = getattr(options, work.__name__), None
        count = 10 if work is tests else 1
        while count <= most:
            with tempfile.TemporaryDirectory() as name:
                cost = measured(work(Path(name), count), options.limit)
            more = (cost.cpu - last[1]) / (count - last[0]) * 1000 if last else 0.0
            told = f"{more:.2f} ms each more" if last else ""
            shown(f"{count:,} {work.__name__}", cost, told)
            last = count, cost.cpu
            count *= 10


def _requirements(count: int) -> str:
    """A specification over ten signals: a limit, or a response within a time of its own."""
    lines = [f"signal x{number} : real" for number in range(10)]
    for number in range(count):
        one, other = f"x{number % 10}", f"x{(number + 3) % 10}"
        lines.append(f"requirement R{number}")
        if number % 2:
            lines.append(f"  always {one} < {5 + number % 7}")
        else:
            lines.append(f"  upon {one} > 2 then within {1 + number % 20} s {other} < 1")
    return "\n".join([*lines, ""])


def _recording(dice: random.Random) -> str:
    names = [f"x{number}" for number in range(10)]
    rows = [
        ",".join([str(row), *(f"{dice.gauss(0, 1):.2f}" for _ in names)]) for row in range(ROWS)
    ]
    return "\n".join([",".join(["t", *names]), *rows, ""])


def large(options: argparse.Namespace) -> None:
    """Write the inputs, run the processes."""
    with tempfile.TemporaryDirectory() as name:
        for title, command in inputs(Path(name)):
            if options.only in title:
                shown(title, measured(command(), options.limit))


def inputs(folder: Path) -> Iterator[tuple[str, Callable[[], list[str]]]]:
    """Each input by name, with what writes it and gives the command that reads it."""

    def written(name: str, text: str) -> str:
        (folder / name).write_text(text, encoding="utf-8")
        return str(folder / name)

    def check(text: str) -> list[str]:
        return [*rvmon("check"), written("s.rv", text)]

    def run(spec: str, trace: str, name: str = "r.csv") -> list[str]:
        return [*rvmon("run"), written("s.rv", spec), written(name, trace)]

    def endless(ending: str) -> list[str]:
        (folder / f"zero.{ending}").symlink_to("/dev/zero")
        return [*rvmon("run"), written("s.rv", SPEC), str(folder / f"zero.{ending}")]

    yield "10,000 requirements: check", lambda: check(many_requirements(10_000))
    for n in (2, 1_000):
        yield (
            f"10,000 requirements: run, {n:,} rows",
            lambda n=n: run(many_requirements(10_000), narrow_csv(n)),
        )
    python = (sys.executable, "-c")
    yield "1,000,000 open attempts: one step decides them", lambda: [*python, OPEN_ATTEMPTS]
    yield "20,000 open instances: one step decides them", lambda: [*python, OPEN_INSTANCES]
    for n in (20_000, 100_000):
        yield f"{n:,} undeclared columns: run", lambda n=n: run(SPEC, wide_csv(n))
        yield (
            f"{n:,} undeclared names: run JSON lines",
            lambda n=n: run(SPEC, wide_jsonl(n), "r.jsonl"),
        )
    for n in (10_000, 100_000):
        yield f"{n:,} declared columns: run", lambda n=n: run(wide_spec(n), wide_csv(n))
    for n in (11, 20):
        yield f"{n} windowed conjuncts: run", lambda n=n: run(windowed(n), wide_csv(n))
    terms = f"{SPEC}requirement R2\n  always {' and '.join(['p'] * 100_000)}\n"
    yield "100,000 terms: check", lambda: check(terms)
    yield "/dev/zero as spec: check", lambda: [*rvmon("check"), "/dev/zero"]
    yield "/dev/zero as import", lambda: check('spec s\nimport "/dev/zero"\n')
    for ending in ("csv", "jsonl", "parquet"):
        yield f"/dev/zero as {ending}: run", lambda ending=ending: endless(ending)
    yield "counters to 10^9: verify", lambda: [*rvmon("verify"), written("m.ta", COUNTERS)]


def rvmon(command: str) -> list[str]:
    """The words that start a subcommand."""
    return [sys.executable, "-m", "rvmon", command]


def many_requirements(count: int) -> str:
    """A spec with so many requirements of three shapes."""
    shapes = (
        "  upon p\n  then within {0} s q\n",
        "  always x < {0}\n",
        "  upon x > {0}\n  then for 2 s p\n",
    )
    return SPEC + "".join(
        f"requirement N{number}\n" + shapes[number % 3].format(number % 100 + 1)
        for number in range(count)
    )


def narrow_csv(count: int) -> str:
    """So many rows in which each value changes now and then."""
    lines = (f"{t},{int(t % 7 < 3)},{int(t % 11 < 2)},{t % 97}\n" for t in range(count))
    return "t,p,q,x\n" + "".join(lines)


def wide_spec(count: int) -> str:
    """A spec that declares so many signals and reads the last."""
    names = ", ".join(f"c{number}" for number in range(count))
    return (
        f"spec s\nsignal x : real\nsignal {names} : bool\nrequirement R1\n  always c{count - 1}\n"
    )


def wide_csv(count: int) -> str:
    """Two rows of so many columns beside `t` and `x`."""
    header = ",".join(f"c{number}" for number in range(count))
    cells = ",".join(["1"] * count)
    return f"t,x,{header}\n0,1,{cells}\n1,2,{cells}\n"


def wide_jsonl(count: int) -> str:
    """Two lines of so many names beside `t` and `x`."""
    names = ",".join(f'"c{number}":1' for number in range(count))
    return "".join(f'{{"t":{t},"x":1,{names}}}\n' for t in range(2))


def windowed(count: int) -> str:
    """A requirement of so many conjuncts, each with a window of its own."""
    names = ", ".join(f"c{number}" for number in range(count))
    parts = " and ".join(
        f"(eventually[{number}.5 s, {number + 1} s] c{number})" for number in range(count)
    )
    return f"spec s\nsignal x : real\nsignal {names} : bool\nrequirement R1\n  always ({parts})\n"


def coverage(options: argparse.Namespace) -> None:
    """Record, then look at it and merge it."""
    rng = random.Random(1)
    each = [Item(f"item {item}") for item in range(options.items // GROUPS)]
    groups = [group_of(f"group {n}", Subject.COVERPOINT, each) for n in range(GROUPS)]
    names = [(group.name, item) for group in groups for item in group.items]
    drawn = [_hits(rng, names, options.share) for _ in range(DIFFERENT)]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "a.cov")
        began = time.process_time()
        with Database.open(path) as database:
            database.declare(model_of(groups))
            for number in range(options.tests):
                test = TestRecord(f"test {number}", "campaign", seed=number, number=number)
                database.record(test, drawn[number % DIFFERENT])
        spent = 1000 * (time.process_time() - began) / options.tests
        print(f"record: {spent:.2f} ms a test; {path.stat().st_size / 1e6:.1f} MB")
        page, other = Path(folder, "a.html"), Path(folder, "b.cov")
        for words in ([], ["--tests"], ["--format", "json"], ["--report", str(page)]):
            cost = measured([*rvmon("cover"), str(path), *words], options.limit)
            shown(" ".join(["cover", *words[:1]]), cost, " ")
        print(f"page: {page.stat().st_size / 1e6:.1f} MB")
        merge = measured([*rvmon("cover"), str(path), "--merge", str(other)], options.limit)
        shown("cover --merge", merge)


def _hits(rng: random.Random, names: list[tuple[str, str]], share: float) -> Hits:
    hits: dict[str, dict[str, Hit]] = {}
    for group, item in rng.sample(names, round(len(names) * share)):
        hits.setdefault(group, {})[item] = Hit(rng.randint(1, 50), rng.randrange(60_000_000_000))
    return hits


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("what", choices=("scale", "large", "coverage"))
    parser.add_argument("--recordings", type=int, default=10_000)
    parser.add_argument("--requirements", type=int, default=1_000)
    parser.add_argument("--tests", type=int, default=100)
    parser.add_argument("--items", type=int, default=1_000)
    parser.add_argument("--share", type=float, default=0.2)
    parser.add_argument("--only", default="", help="inputs whose name holds this word")
    parser.add_argument("--limit", type=float, default=600.0, help="seconds for one process")
    options = parser.parse_args()
    print(f"{'':44}{'s':>8}{'CPU s':>8}{'MiB':>8}{'exit':>6}")
    {"scale": scale, "large": large, "coverage": coverage}[options.what](options)


if __name__ == "__main__":
    main()
