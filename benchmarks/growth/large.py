"""Inputs that are large, or all decided at once; each is given to a process of its own."""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from benchmarks.growth.scale import measured, rvmon, shown

SPEC = "spec s\nsignal p, q : bool\nsignal x : real\nrequirement R1\n  always x < 3\n"

LEAP = """spec s
signal p, q : bool
signal x : real
requirement R1
  whenever p then within 1 h q
requirement R2
  always (x > 3 -> within 2 s x < 3)
"""

KEYED = """spec s
signal p, q : bool
signal x : real
event ask(id: int)
event answer(id: int)
requirement R1
  {}
"""

FAILURES = {
    "one after the other": "always (p -> within 10 s q)",
    "each with a captured value": "upon p then within 3 s (q and x > v) let v = x",
    "each of an instance": "upon ask then within 3 s answer.id == n for each n in ask.id",
    "by a trigger that never came true": "upon p and q and held(p, 1 h) then q",
}
"""What failures there are in a recording that was found to fail often."""

FIRST_MONITOR = """
import sys, time, rvmon
from benchmarks.growth.large import many_requirements
spec = rvmon.loads(many_requirements(int(sys.argv[1])))
begun = time.process_time()
monitor = spec.monitor()
made, begun = time.process_time() - begun, time.process_time()
for t in range(200):
    monitor.step_ns(t * 10**9, {"p": t % 7 < 3, "q": t % 11 < 2, "x": t % 97})
print(f"made in {made:.2f} s, {(time.process_time() - begun) / 200 * 1e6:.1f} us a step")
"""
"""What it takes until the first sample can be judged, and a step then."""

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

    python = (sys.executable, "-c")
    # A silence of years in four rows, with a deadline of an hour: see `Report.dropped`.
    leap = "t,p,q,x\n0,0,0,1\n1,1,0,9\n1700000000,1,1,1\n1700000001,0,1,1\n"
    yield "four rows with a leap of 54 years: run", lambda: run(LEAP, leap)
    for n in (200_000, 2_000_000):
        yield f"{n:,} rows of JSON lines: run", lambda n=n: run(SPEC, narrow_jsonl(n), "r.jsonl")
    yield (
        "200,000 rows with semicolons and decimal commas: run",
        lambda: run(SPEC, foreign_csv(200_000)),
    )
    yield "200,000 rows, 10,000 labels: run", lambda: run(labelled_spec(10_000), labelled_csv())
    for kind, requirement in FAILURES.items():
        yield (
            f"200,000 rows, failures {kind}: run",
            lambda own=requirement: run(KEYED.format(own), keyed_csv(200_000)),
        )
    yield "1,000 requirements: first monitor", lambda: [*python, FIRST_MONITOR, "1000"]
    yield "10,000 requirements: first monitor", lambda: [*python, FIRST_MONITOR, "10000"]
    yield "10,000 requirements: check", lambda: check(many_requirements(10_000))
    for n in (2, 1_000):
        yield (
            f"10,000 requirements: run, {n:,} rows",
            lambda n=n: run(many_requirements(10_000), narrow_csv(n)),
        )
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


def keyed_csv(count: int) -> str:
    """So many rows that ask, each a question of its own, which is seldom answered in time."""
    lines = (
        f"{t},{int(t % 7 < 3)},{int(t % 11 < 2)},{t // 10},"
        f"{1 if t % 5 == 0 else ''},{t if t % 5 == 0 else ''},"
        f"{1 if t % 5 == 4 else ''},{t - 9 if t % 5 == 4 else ''}\n"
        for t in range(count)
    )
    return "t,p,q,x,ask,ask.id,answer,answer.id\n" + "".join(lines)


def foreign_csv(count: int) -> str:
    """The same as programs write it where numbers have commas."""
    lines = (f"{t};{int(t % 7 < 3)};{int(t % 11 < 2)};{t % 97},5\n" for t in range(count))
    return "t;p;q;x\n" + "".join(lines)


def labelled_spec(count: int) -> str:
    """A spec with a signal of so many labels."""
    labels = ", ".join(f"l{number}" for number in range(count))
    return f"spec s\nsignal mode : {{{labels}}}\nrequirement R1\n  always mode != l3\n"


def labelled_csv() -> str:
    """Rows of 10,000 labels, of which neighbours differ."""
    return "t,mode\n" + "".join(f"{t},l{t * 7919 % 10_000}\n" for t in range(200_000))


def narrow_jsonl(count: int) -> str:
    """The same as JSON lines."""
    lines = (f'{{"t":{t},"p":{t % 7 < 3},"q":{t % 11 < 2},"x":{t % 97}}}\n' for t in range(count))
    return "".join(lines).replace("True", "true").replace("False", "false")


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
