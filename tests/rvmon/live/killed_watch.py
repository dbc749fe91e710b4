"""Watches that are killed at random points, beside one that is not."""

import json
import os
import random
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from tests.tools.servers import LONG

from rvmon.cli import main
from rvmon.trace.time import NEVER, TICKS_PER_SECOND


class Forked:
    """A function in a forked process that leads its own process group and can be killed.

    Args:
        run: returns the exit code.
        folder: the working directory.
        out: file for standard output; standard error goes to this name with `.err`.
    """

    def __init__(self, run: Callable[[], object], folder: Path, out: Path) -> None:
        self._out = out
        out.write_bytes(b"")
        self._process = get_context("fork").Process(target=_alone, args=(run, folder, out))
        self._process.start()

    @property
    def code(self) -> int | None:
        """The exit code, negative for a signal, or `None` while the process runs."""
        return self._process.exitcode

    def kill_behind(self, size: int) -> bool:
        """Kill the process once it has written `size` bytes; `False` if it ended before."""
        return self.kill_when(lambda: self._out.stat().st_size >= size)

    def lines(self) -> list[str]:
        """The complete lines of the output."""
        text = self._out.read_text()
        return [line for line in text.splitlines(keepends=True) if line.endswith("\n")]

    def kill_when(self, is_time: Callable[[], bool]) -> bool:
        """Kill the process group once a condition holds; `False` if the process ended before."""
        end, pid = time.monotonic() + 20 * LONG, self._process.pid
        assert pid, "it was started"
        while self.code is None:
            is_late = time.monotonic() > end
            if is_late or is_time():
                with suppress(ProcessLookupError):  # it does not lead a group yet
                    os.killpg(pid, signal.SIGKILL)
                self._process.kill()
                self._process.join()
                if is_late:
                    raise TimeoutError("it has not come so far")
                return True
            time.sleep(0.001)
        return False


def _alone(run: Callable[[], object], folder: Path, out: Path) -> None:
    os.setsid()
    os.chdir(folder)
    for number, path in ((1, str(out)), (2, f"{out}.err")):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), number)
    sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
    code = run()
    sys.exit(code if isinstance(code, int) else 0)


SPEC = """
spec kept
signal p : bool
signal speed : real stale after 50 ms
event go
event pick(id: int), done(id: int)
requirement R1
  upon go
  then within 25 ms p
requirement R2
  always speed <= 1
requirement R3
  upon pick
  then within 30 ms done.id == n
  for each n in pick.id
"""

Verdicts = dict[int, Mapping[str, Any]]


def samples(rng: random.Random, count: int) -> Iterator[tuple[int, dict[str, Any]]]:
    """Stamps in nanoseconds and values; stamps may be equal, and some are late."""
    t = 0
    for _ in range(count):
        t += rng.choice((0, 1, 7, 7, 9, 60)) * TICKS_PER_SECOND // 1000
        values: dict[str, Any] = {}
        if rng.random() < 0.6:
            values["speed"] = rng.choice((0.5, 0.9, 2.0, None))
        if rng.random() < 0.3:
            values["p"] = rng.random() < 0.5
        if rng.random() < 0.2:
            values["go"] = True
        name = rng.choice(("pick", "done", ""))
        if name:
            values[name] = {"id": rng.randrange(20)}
        yield t - (50_000_000 if rng.random() < 0.01 else 0), values


def written(folder: Path, seed: int, count: int) -> None:
    """Write the specification and the samples as lines, some of them torn."""
    rng = random.Random(seed)
    (folder / "kept.rv").write_text(SPEC)
    lines = [json.dumps({"t_ns": t, **values}) for t, values in samples(rng, count)]
    torn = (f"{line}\ntorn {{\n" if rng.random() < 0.005 else f"{line}\n" for line in lines)
    (folder / "lines.jsonl").write_text("".join(torn))


def told(lines: Iterable[str], known: Verdicts) -> Verdicts:
    """Add the reported verdicts to the known ones; repeated numbers must have the same content."""
    for line in lines:
        verdict = json.loads(line)
        assert known.setdefault(verdict["number"], verdict) == verdict, "repeated with a change"
    return known


WATCH = "watch kept.rv lines.jsonl --state {} --format json"


def killed(folder: Path, kills: int, seed: int) -> tuple[Verdicts, Verdicts, int]:
    """Verdicts of a whole watch, verdicts of one that is killed and resumed, number of kills."""
    rng, found, done = random.Random(seed), Verdicts(), 0
    whole = Forked(partial(main, WATCH.format("whole.state").split()), folder, folder / "told")
    whole.kill_when(lambda: False)
    expected, each = told(whole.lines(), {}), max(1, len("".join(whole.lines())) // (kills + 1))
    while True:
        run = partial(main, WATCH.format("killed.state").split())
        process = Forked(run, folder, folder / "told")
        after = rng.randrange(1, 2 * each) if done < kills else NEVER
        done += process.kill_behind(after)
        told(process.lines(), found)
        if process.code != -signal.SIGKILL:
            return expected, found, done
