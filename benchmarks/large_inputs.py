"""What large and endless inputs cost: each is judged by a process of its own.

    python -m benchmarks.large_inputs [--only WORD] [--limit SECONDS]

Prints a table: seconds of wall time, peak memory in MiB, the exit code, and the last line that was
said. A process that needs longer than the limit is stopped; none may take more than 6 GiB.
"""

from __future__ import annotations

import argparse
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

SPEC = "spec s\nsignal p, q : bool\nsignal x : real\nrequirement R1\n  always x < 3\n"
MOST_MEMORY = 6 << 30

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


class Cost(NamedTuple):
    """What one process cost, and how it ended."""

    seconds: float
    mebibytes: float
    code: int
    said: str


def main(argv: Sequence[str]) -> int:
    """Write the inputs, run the processes, print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", default="", help="inputs whose name holds this word")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds for one process")
    options = parser.parse_args(argv)
    print(f"{'input':44}{'s':>8}{'MiB':>8}{'exit':>6}  last line")
    with tempfile.TemporaryDirectory() as name:
        for title, command in inputs(Path(name)):
            if options.only not in title:
                continue
            cost = measured(command(), options.limit)
            said = cost.said if len(cost.said) <= 70 else cost.said[:69] + "…"
            print(
                f"{title:44}{cost.seconds:8.1f}{cost.mebibytes:8.0f}{cost.code:6}  {said}",
                flush=True,
            )
    return 0


def inputs(folder: Path) -> Iterator[tuple[str, Callable[[], list[str]]]]:
    """Each input by name, with what writes it and gives the command that reads it."""

    def written(name: str, text: str) -> str:
        (folder / name).write_text(text, encoding="utf-8")
        return str(folder / name)

    def run(spec: str, trace: str, *words: str) -> list[str]:
        return [*rvmon("run"), *words, written("s.rv", spec), trace]

    yield (
        "10,000 requirements: check",
        lambda: [
            *rvmon("check"),
            written("s.rv", many_requirements(10_000)),
        ],
    )
    for rows in (2, 1_000):
        yield (
            f"10,000 requirements: run, {rows:,} rows",
            lambda rows=rows: run(many_requirements(10_000), written("r.csv", narrow_csv(rows))),
        )
    yield (
        "1,000,000 open attempts: one step decides them",
        lambda: [sys.executable, "-c", OPEN_ATTEMPTS],
    )
    yield (
        "20,000 open instances: one step decides them",
        lambda: [sys.executable, "-c", OPEN_INSTANCES],
    )
    for count in (20_000, 100_000):
        yield (
            f"{count:,} undeclared columns: run",
            lambda count=count: run(SPEC, written("r.csv", wide_csv(count))),
        )
        yield (
            f"{count:,} undeclared names: run JSON lines",
            lambda count=count: run(SPEC, written("r.jsonl", wide_jsonl(count))),
        )
    for count in (10_000, 100_000):
        yield (
            f"{count:,} declared columns: run",
            lambda count=count: run(wide_spec(count), written("r.csv", wide_csv(count))),
        )
    for count in (11, 20):
        yield (
            f"{count} windowed conjuncts: run",
            lambda count=count: run(windowed(count), written("r.csv", wide_csv(count))),
        )
    yield (
        "100,000 terms: check",
        lambda: [
            *rvmon("check"),
            written(
                "s.rv", SPEC + "requirement R2\n  always " + " and ".join(["p"] * 100_000) + "\n"
            ),
        ],
    )
    yield (
        "/dev/zero as spec: run",
        lambda: [*rvmon("run"), "/dev/zero", written("r.csv", "t,x\n0,1\n")],
    )
    yield "/dev/zero as spec: check", lambda: [*rvmon("check"), "/dev/zero"]
    yield (
        "/dev/zero as import",
        lambda: [*rvmon("check"), written("s.rv", 'spec s\nimport "/dev/zero"\n')],
    )
    for ending in ("csv", "jsonl", "parquet"):
        yield f"/dev/zero as {ending}: run", lambda ending=ending: run(SPEC, linked(folder, ending))
    yield (
        "counters to 10^9: verify",
        lambda: [
            *rvmon("verify"),
            written("m.ta", counters()),
        ],
    )


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


def linked(folder: Path, ending: str) -> str:
    """A link to /dev/zero that is named as a recording."""
    link = folder / f"zero.{ending}"
    link.unlink(missing_ok=True)
    link.symlink_to("/dev/zero")
    return str(link)


def counters() -> str:
    """A model of timed automata with counters to 10^9."""
    return """
int[0, 1000000000] a, b
automaton counting {
  clock x
  location going invariant x <= 1
  start going
  edge going -> going when x >= 1 do x = 0, a = a + 1
}
query far: E<> a == 1000000000
"""


def measured(command: Sequence[str], limit: float) -> Cost:
    """Run one process, at most so many seconds."""

    def bounded() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))

    begun = time.monotonic()
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
    said = lines[-1] if lines else ""
    return Cost(seconds, usage.ru_maxrss / 1024, process.returncode, said)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
