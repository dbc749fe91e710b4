"""Inputs that are large, or all decided at once; each is given to a process of its own."""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from benchmarks.growth.scale import RVMON, cost_of

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
  """

FAILURES = {
    "one after the other": "always (p -> within 10 s q)",
    "each with a captured value": "upon p then within 3 s (q and x > v) let v = x",
    "each of an instance": "upon ask then within 3 s answer.id == n for each n in ask.id",
    "by a trigger that never came true": "upon p and q and held(p, 1 h) then q",
}
"""What failures there are in a recording that was found to fail often."""

ROWS = {
    "r.csv": ("t,p,q,x\n", "{t},{p},{q},{x}\n"),
    "foreign.csv": ("t;p;q;x\n", "{t};{p};{q};{x},5\n"),
    "r.jsonl": ("", '{{"t":{t},"p":{word},"q":true,"x":{x}}}\n'),
    "labels.csv": ("t,mode\n", "{t},l{label}\n"),
    "keyed.csv": (
        "t,p,q,x,ask,ask.id,answer,answer.id\n",
        "{t},{p},{q},{slow},{ask},{asked},{answer},{answered}\n",
    ),
}
"""Of a file its first line, and the others; values change now and then, few keys are answered."""

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

OPENED = {
    "attempts": (1_000_000, "upon req then within 1000000000 s p"),
    "instances": (20_000, "upon req.id == k then within 50000 s done.id == k for each k in req.id"),
}
OPEN = """
import gc, sys, time, rvmon
monitor = rvmon.loads('''spec s
signal p : bool
event req(id: int), done(id: int)
requirement R1
  {requirement}
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
took = [stepped(t, {{"req": {{"id": t}}, "p": False}}) for t in range({count})]
print(f"{{sum(took):.1f}} s, the longest {{max(took):.2f}} s", end=", ")
print(f"the collector's {{max(pauses):.2f}} s", end="; ")
print(f"all decided in {{stepped(1_000_000_000, {{}}):.2f}} s")
"""
"""Attempts, or instances, are opened one by one, then time decides all at once."""

Command = Callable[[], list[str]]


def large(options: argparse.Namespace) -> None:
    with tempfile.TemporaryDirectory() as name:
        for title, command in inputs(Path(name)):
            if options.only in title:
                cost_of(title, command(), options.limit)


def inputs(folder: Path) -> Iterator[tuple[str, Command]]:
    """Each input by name, with what writes it and gives the command that reads it."""

    def written(name: str, text: str) -> str:
        (folder / name).write_text(text, encoding="utf-8")
        return str(folder / name)

    def run(spec: str, trace: str, name: str = "r.csv") -> list[str]:
        return [*RVMON, "run", written("s.rv", spec), written(name, trace)]

    def recorded(spec: str, name: str, count: int) -> list[str]:
        return run(spec, rows(name, count), name)

    # A silence of years in four rows, with a deadline of an hour: see `Report.dropped`.
    leap = "t,p,q,x\n0,0,0,1\n1,1,0,9\n1700000000,1,1,1\n1700000001,0,1,1\n"
    yield "four rows with a leap of 54 years: run", partial(run, LEAP, leap)
    for n in (200_000, 2_000_000):
        yield f"{n:,} rows of JSON lines: run", partial(recorded, SPEC, "r.jsonl", n)
    title = "200,000 rows with semicolons and decimal commas: run"
    yield title, partial(recorded, SPEC, "foreign.csv", 200_000)
    labels = ", ".join(f"l{number}" for number in range(10_000))
    spec = f"spec s\nsignal mode : {{{labels}}}\nrequirement R1\n  always mode != l3\n"
    yield "200,000 rows, 10,000 labels: run", partial(recorded, spec, "labels.csv", 200_000)
    for kind, own in FAILURES.items():
        title = f"200,000 rows, failures {kind}: run"
        yield title, partial(recorded, f"{KEYED}{own}\n", "keyed.csv", 200_000)
    for n in (1_000, 10_000):
        words = [sys.executable, "-c", FIRST_MONITOR, str(n)]
        yield f"{n:,} requirements: first monitor", partial(list, words)
    many = many_requirements(10_000)
    for n in (2, 1_000):
        yield f"10,000 requirements: run, {n:,} rows", partial(recorded, many, "r.csv", n)
    for what, (count, own) in OPENED.items():
        words = [sys.executable, "-c", OPEN.format(requirement=own, count=count)]
        yield f"{count:,} open {what}: one step decides them", partial(list, words)
    for n in (20_000, 100_000):
        yield f"{n:,} undeclared columns: run", partial(run, SPEC, wide_csv(n))
        names = ",".join(f'"c{number}":1' for number in range(n))
        lines = "".join(f'{{"t":{t},"x":1,{names}}}\n' for t in range(2))
        yield f"{n:,} undeclared names: run JSON lines", partial(run, SPEC, lines, "r.jsonl")
    for n in (10_000, 100_000):
        yield f"{n:,} declared columns: run", partial(run, wide_spec(n), wide_csv(n))


def rows(name: str, count: int) -> str:
    first, line = ROWS[name]
    return first + "".join(
        line.format(
            t=t,
            p=int(t % 7 < 3),
            q=int(t % 11 < 2),
            x=t % 97,
            word="true" if t % 7 < 3 else "false",
            label=t * 7919 % 10_000,
            slow=t // 10,
            ask=1 if t % 5 == 0 else "",
            asked=t if t % 5 == 0 else "",
            answer=1 if t % 5 == 4 else "",
            answered=t - 9 if t % 5 == 4 else "",
        )
        for t in range(count)
    )


def many_requirements(count: int) -> str:
    """A spec with so many requirements of three shapes."""
    shapes = ("upon p\n  then within {0} s q", "always x < {0}", "upon x > {0}\n  then for 2 s p")
    return SPEC + "".join(
        f"requirement N{number}\n  {shapes[number % 3].format(number % 100 + 1)}\n"
        for number in range(count)
    )


def wide_spec(count: int) -> str:
    """A spec that declares so many signals, and reads the last."""
    names = ", ".join(f"c{number}" for number in range(count))
    head = f"spec s\nsignal x : real\nsignal {names} : bool\n"
    return f"{head}requirement R1\n  always c{count - 1}\n"


def wide_csv(count: int) -> str:
    """Two rows of so many columns beside `t` and `x`."""
    header = ",".join(f"c{number}" for number in range(count))
    cells = ",".join(["1"] * count)
    return f"t,x,{header}\n0,1,{cells}\n1,2,{cells}\n"
