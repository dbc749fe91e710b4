"""Nanoseconds of the processor per sample, a step for each: by form, kind of input and number.

    python -m benchmarks.online [--quick] [--only SECTION …] [--r2u2 FOLDER]
    python -m benchmarks.online --kinds [WORD …] [--rows 4000] [--time sampled] [--unknown 1]

Beside all peers that install, in an environment of their own, made from the package index at first;
and R2U2, of which FOLDER holds a clone. A ratio counts only where verdicts agree. `--kinds` takes
every kind of requirement that people write, published ones, windows of many lengths, ours alone.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path

import numpy as np
from benchmarks.page import Findings, findings_of, render
from benchmarks.peers import dialects
from benchmarks.peers.client import Peer
from benchmarks.peers.dialects import spelling, translate
from benchmarks.peers.environment import Environment, prepare
from benchmarks.peers.native import Native, build
from benchmarks.timing import kinds, robot, suite
from benchmarks.timing.agreement import Agreement, Referee, peers_in
from benchmarks.timing.contenders import contenders, margin_text
from benchmarks.timing.measure import QUICK, Result, Size, measure
from benchmarks.timing.r2u2 import R2u2
from benchmarks.timing.workload import Workload

from rvmon import loads
from rvmon.monitor.robustness import Measured

SECTIONS = ("online", "robot", "many", "bound", "unsteady", "failing", "margins")
BUILT_FOR = ("many", "bound")
"""Sections that R2U2 takes part in: it is built anew for each workload."""

COMPARED_ROWS = 2_000
"""Of which all figures of robustness are compared."""


def workloads(size: Size, sections: Sequence[str]) -> Iterator[Workload]:
    """What is measured in the chosen sections."""
    made = {
        "online": lambda: suite.families(size.rows, size.bounds),
        "robot": lambda: robot.workloads(size.seconds),
        "many": lambda: suite.many(size.rows // 2, size.counts),
        "bound": lambda: suite.bounds(size.longest),
        "unsteady": lambda: suite.unsteady("unsteady", size.rows),
        "failing": lambda: suite.failing(size.rows),
        "margins": lambda: suite.unsteady("margins", size.rows),
        "batch": lambda: suite.batches(size.columns),
    }
    for section in sections:
        yield from made[section]()


def run(
    size: Size,
    sections: Sequence[str],
    environment: Environment,
    native: Native,
    r2u2: Path | None,
) -> tuple[list[Result], list[Agreement]]:
    """Measure the chosen sections, reporting what is under way."""
    results: list[Result] = []
    agreements: list[Agreement] = []
    with Referee(peers_in(environment), size.traces, size.step_seconds, say) as referee:
        for section, group in groupby(workloads(size, sections), lambda one: one.section):
            taking_part = list(contenders(environment, native, section))
            if r2u2 is not None and section in BUILT_FOR:
                taking_part.append(R2u2(r2u2))
            for workload in group:
                say(f"{section}: {workload.name}, {workload.form}")
                results.append(measure(workload, taking_part, size.plan_of(section)))
                if section == "margins":
                    agreements += margins_alike(workload, environment)
                    continue
                agreements += referee.check(workload, results[-1].figures)
                agreements += [
                    one.agreement(workload)
                    for one in taking_part
                    if isinstance(one, R2u2) and one.built_for == workload.name
                    if workload.form == "future"
                ]
            for contender in taking_part:
                contender.close()
    return results, agreements


def margins_alike(workload: Workload, environment: Environment) -> Iterator[Agreement]:
    """Whether SENTIL's figures are ours: by arrays, a sample at a time, and as it is required.

    It counts a window that the trace cuts short as it is; ours is then no single number.
    """
    if "sentil" not in environment.versions:
        return
    columns = {name: np.array(column[:COMPARED_ROWS]) for name, column in workload.columns.items()}
    named = {spelling(name): column.tolist() for name, column in columns.items()}
    text = translate(workload.formulas[0], dialects.SENTIL)
    with Peer(environment.python, "sentil") as peer:
        theirs = peer.ask("judge", formula=text, kind="discrete", columns=named)["values"]
    spec = loads(margin_text(workload))
    offline = spec.robustness({"t_ns": np.arange(COMPARED_ROWS), **columns}, time="t_ns")
    told = [[(t, one.low, one.high) for t, one in offline.streams["R1"]]]
    for streams in (True, False):
        monitor = spec.robustness_monitor(streams=streams)
        found: list[Measured] = []
        for t, row in enumerate(zip(*columns.values(), strict=True)):
            found += monitor.step_ns(t, dict(zip(columns, map(float, row), strict=True)))
        told.append([(one.t, one.robustness.low, one.robustness.high) for one in found])
    sure = {t for t, low, high in told[0] if low == high}
    pairs = [(low, theirs[t]) for own in told for t, low, _ in own if t in sure]
    equal, false = (sum(own == its for own, its in pairs), sum(own < 0 for own, _ in pairs))
    yield Agreement("sentil", workload.name, workload.form, equal, len(pairs), false)


_BEGAN = time.monotonic()


def say(text: str) -> None:
    """Tell what is under way."""
    print(f"{time.monotonic() - _BEGAN:4.0f} s  {text}", file=sys.stderr, flush=True)


def main(argv: Sequence[str]) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a few minutes, for a first look")
    parser.add_argument("--only", nargs="+", choices=SECTIONS, default=SECTIONS, metavar="SECTION")
    parser.add_argument("--r2u2", type=Path, help="a clone of its repository", metavar="FOLDER")
    parser.add_argument("--kinds", nargs="*", metavar="WORD", help="ours alone, by requirement")
    kinds.add_options(parser)
    options = parser.parse_args(argv)
    if options.kinds is not None:
        return kinds.measure(options)
    environment = prepare()
    size = QUICK if options.quick else Size()
    results, agreements = run(size, options.only, environment, build(environment), options.r2u2)
    command = " ".join(["python -m benchmarks.online", *argv])
    found: Findings = findings_of(command, environment, results, agreements)
    print(render(found))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
