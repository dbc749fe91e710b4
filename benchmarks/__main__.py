"""Measure our monitors beside the peers and write the page of results.

    python -m benchmarks [--quick] [--only SECTION …] [--r2u2 FOLDER] [--out FILE]

Peers run in their own environment beside this file, made from the package index on the first run.
"""

from __future__ import annotations

import argparse
import platform
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from itertools import groupby
from pathlib import Path

from benchmarks.agreement import Agreement, Referee, peers_in
from benchmarks.attempts import OpenAttempts, measure_open
from benchmarks.contenders import contenders
from benchmarks.files import measure_files
from benchmarks.measure import Plan, Result, measure
from benchmarks.peers import differences
from benchmarks.peers.client import PeerError
from benchmarks.peers.environment import prepare
from benchmarks.peers.native import build
from benchmarks.processes import measure_process
from benchmarks.r2u2 import table as many_beside_r2u2
from benchmarks.results import Findings, render
from benchmarks.workload import Workload

from benchmarks import suite

OUT = Path(__file__).with_name("RESULTS.md")
SECTIONS = (
    "online",
    "robot",
    "many",
    "bound",
    "unsteady",
    "failing",
    "batch",
    "process",
    "files",
    "open",
    "differences",
)

LONGER = {"batch": 10, "many": 5}
"""So many times as long is a pass, of what is judged as a whole or takes long to begin."""


@dataclass(frozen=True, slots=True)
class Size:
    """How much is measured.

    Attributes:
        rows: of the traces that are judged row by row.
        columns: rows of what is judged in memory or by whole processes.
        longest: rows of the traces on which deadlines grow.
        bounds: of the Timescales families.
        seconds: of the robot's stream.
        counts: of monitors on one stream.
        attempts: held open.
        traces: damaged ones per agreement.
        step_seconds: that a peer may step on one workload to be compared.
        repeats: passes of each contender.
        processes: of each program, beside a first one that does not count.
        file_rows: of one large file.
        files: of many.
        pass_seconds: what one pass may take.
    """

    rows: int = 50_000
    columns: int = 1_000_000
    longest: int = 300_000
    bounds: tuple[int, ...] = (10, 100, 1000)
    seconds: int = 300
    counts: tuple[int, ...] = (10, 100, 1000)
    attempts: tuple[int, ...] = (1, 10, 100, 1_000, 10_000, 100_000)
    traces: int = 2
    step_seconds: float = 90
    repeats: int = 5
    processes: int = 3
    file_rows: int = 10_000_000
    files: int = 1_000
    pass_seconds: float = 0.1

    def plan_of(self, section: str) -> Plan:
        """Repeats and time of a pass."""
        return Plan(self.repeats, self.pass_seconds * LONGER.get(section, 1))


QUICK = Size(
    rows=5_000,
    columns=100_000,
    longest=20_000,
    bounds=(10, 1000),
    seconds=60,
    counts=(10, 100),
    attempts=(1, 1_000, 10_000),
    traces=1,
    step_seconds=10,
    repeats=3,
    processes=2,
    file_rows=1_000_000,
    files=40,
    pass_seconds=0.05,
)


def workloads(size: Size, sections: Sequence[str]) -> Iterator[Workload]:
    """What is measured in the chosen sections."""
    if "online" in sections:
        yield from suite.families(size.rows, size.bounds)
    if "robot" in sections:
        yield from suite.robots(size.seconds)
    if "many" in sections:
        yield from suite.many(size.rows // 2, size.counts)
    if "bound" in sections:
        yield from suite.bounds(size.longest)
    if "unsteady" in sections:
        yield from suite.unsteady(size.rows)
    if "failing" in sections:
        yield from suite.failing(size.rows)
    if "batch" in sections:
        yield from suite.batches(size.columns)


def machine() -> str:
    """Processor, cores, system and interpreter."""
    name = platform.processor() or platform.machine()
    for line in _lines(Path("/proc/cpuinfo")):
        if line.startswith("model name"):
            name = line.partition(":")[2].strip()
            break
    cores = sum(line.startswith("processor") for line in _lines(Path("/proc/cpuinfo")))
    python = f"{platform.python_implementation()} {platform.python_version()}"
    return f"{name}, {cores} cores, {platform.system()} {platform.release()}, {python}"


def _lines(path: Path) -> list[str]:
    return path.read_text().splitlines() if path.exists() else []


def run(size: Size, sections: Sequence[str], command: str, r2u2: Path | None) -> Findings:
    """Measure all chosen sections, and beside R2U2 from a folder, reporting what is under way."""
    began = time.monotonic()

    def say(text: str) -> None:
        _say(f"{time.monotonic() - began:4.0f} s  {text}")

    environment = prepare()
    native = build(environment)
    results: list[Result] = []
    agreements: list[Agreement] = []
    absent = dict(environment.missing)
    with Referee(peers_in(environment), size.traces, size.step_seconds, say) as referee:
        for section, group in groupby(workloads(size, sections), lambda one: one.section):
            taking_part = list(contenders(environment, native, section))
            for workload in group:
                say(f"{section}: {workload.name}, {workload.form}")
                results.append(measure(workload, taking_part, size.plan_of(section)))
                agreements += referee.check(workload, results[-1].figures)
            for contender in taking_part:
                contender.close()
        for workload in suite.processed(size.columns) if "process" in sections else ():
            say(f"process: {workload.name}")
            with tempfile.TemporaryDirectory() as folder:
                place = Path(folder)
                results.append(
                    measure_process(workload, size.processes, environment, native, place)
                )
            agreements += referee.check(workload, results[-1].figures)
    open_attempts: list[OpenAttempts] = []
    if "open" in sections:
        say("open attempts")
        try:
            for found in measure_open(size.repeats, size.attempts):
                open_attempts.append(found)  # noqa: PERF402 - those before an error count
        except PeerError as error:
            absent["open attempts"] = str(error)
    files: tuple[str, ...] = ()
    if "files" in sections:
        say("whole files")
        with tempfile.TemporaryDirectory() as folder:
            measured = measure_files(
                size.file_rows, size.files, size.processes, environment, Path(folder)
            )
            files = tuple(measured)
    if "differences" in sections:
        say("where the peers read otherwise")
    beside: tuple[str, ...] = ()
    if r2u2 is not None:
        say("many monitors beside R2U2")
        beside = tuple(many_beside_r2u2(r2u2, size.rows // 2, size.counts))
    else:
        absent["R2U2"] = "the package index has none; `--r2u2` with a clone of its repository"
    table = differences.table(environment) if "differences" in sections else []
    versions = {"rvmon": version("rvmon"), **environment.versions}
    if native.binary is None:
        absent["reelay C++"] = native.reason
    return Findings(
        command,
        machine(),
        versions,
        tuple(results),
        tuple(open_attempts),
        tuple(agreements),
        tuple(table),
        files,
        beside,
        absent,
    )


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def parse(argv: Sequence[str]) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks", description="Measure our monitors beside the peers."
    )
    parser.add_argument("--quick", action="store_true", help="a few minutes, for a first look")
    parser.add_argument("--only", nargs="+", choices=SECTIONS, default=SECTIONS, metavar="SECTION")
    parser.add_argument("--r2u2", type=Path, help="a clone of its repository", metavar="FOLDER")
    parser.add_argument("--out", type=Path, default=OUT, metavar="FILE")
    return parser.parse_args(argv)


def main(argv: Sequence[str]) -> int:
    """Measure and write the page."""
    options = parse(argv)
    size = QUICK if options.quick else Size()
    shown = ["FOLDER" if Path(one) == options.r2u2 else one for one in argv]
    command = " ".join(["python -m benchmarks", *shown])
    findings = run(size, options.only, command, options.r2u2)
    options.out.write_text(render(findings), encoding="utf-8")
    _say(f"wrote {options.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
