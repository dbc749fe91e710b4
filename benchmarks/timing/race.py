"""Workloads, given to all who take part in a section, and whether they judge alike."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path

import numpy as np
from benchmarks.peers.client import Peer
from benchmarks.peers.environment import Environment
from benchmarks.peers.ways import WAYS, Question
from benchmarks.timing import robot, suite
from benchmarks.timing.agreement import Agreement, Referee, peers_in
from benchmarks.timing.contenders import contenders, margin_text
from benchmarks.timing.measure import Result, Size, measure
from benchmarks.timing.r2u2 import R2u2
from benchmarks.timing.workload import Workload

from rvmon import loads
from rvmon.monitor.robustness import Measured

ONLINE = ("online", "robot", "many", "bound", "unsteady", "failing", "margins")
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
        if section in made:
            yield from made[section]()


def run(
    size: Size, sections: Sequence[str], environment: Environment, r2u2: Path | None
) -> tuple[list[Result], list[Agreement]]:
    """Measure the chosen sections, reporting what is under way."""
    results: list[Result] = []
    agreements: list[Agreement] = []
    with Referee(peers_in(environment), size.traces, size.step_seconds, say) as referee:
        for section, group in groupby(workloads(size, sections), lambda one: one.section):
            taking_part = list(contenders(environment, section))
            if r2u2 is not None and section in BUILT_FOR:
                taking_part.append(R2u2(r2u2))
            for workload in group:
                say(f"{section}: {workload.name}, {workload.form}")
                seconds = size.seconds_of(section)
                results.append(measure(workload, taking_part, size.repeats, seconds))
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
    way = WAYS["sentil"]
    if way.package not in environment.versions:
        return
    columns = {name: list(column[:COMPARED_ROWS]) for name, column in workload.columns.items()}
    with Peer(environment.python, way.adapter) as peer:
        theirs = way.says(peer, Question(workload.formulas[0], columns))
    spec = loads(margin_text(workload))
    arrays = {name: np.array(column) for name, column in columns.items()}
    offline = spec.robustness({"t_ns": np.arange(COMPARED_ROWS), **arrays}, time="t_ns")
    told = [[(t, one.low, one.high) for t, one in offline.streams["R1"]]]
    for streams in (True, False):
        monitor = spec.robustness_monitor(streams=streams)
        found: list[Measured] = []
        for t, row in enumerate(zip(*columns.values(), strict=True)):
            found += monitor.step_ns(t, dict(zip(columns, row, strict=True)))
        told.append([(one.t, one.robustness.low, one.robustness.high) for one in found])
    sure = {t for t, low, high in told[0] if low == high}
    pairs = [(low, theirs[t]) for own in told for t, low, _ in own if t in sure]
    equal, false = (sum(own == its for own, its in pairs), sum(own < 0 for own, _ in pairs))
    yield Agreement("sentil", workload.name, workload.form, equal, len(pairs), false)


_BEGAN = time.monotonic()


def say(text: str) -> None:
    print(f"{time.monotonic() - _BEGAN:4.0f} s  {text}", file=sys.stderr, flush=True)
