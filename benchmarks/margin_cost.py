"""What robustness costs per sample, beside SENTIL, with its figures compared.

    pip install sentil
    python -m benchmarks.margin_cost [--rows 20000] [--repeats 7]

The five forms of `unsteady`, over values drawn anew at every row; positions are samples. Online,
SENTIL gives a figure with each sample, of one whose windows are over; so does `stream`, as an
object; `attempt` follows what is owed from the first sample on, and no other. Offline all give an
array with a figure per sample: SENTIL's is what ours are compared with. Processor time, nanoseconds
per sample: the least of all repeats and, behind a slash, the median; all take turns.
"""

from __future__ import annotations

import argparse
import importlib
import statistics
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from benchmarks.peers import dialects
from benchmarks.peers.dialects import spelling, translate
from benchmarks.suite import unsteady
from benchmarks.workload import Workload

from rvmon.session import Spec
from rvmon.spec.checked.formula import Bound, BoundAtom
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement, Signal, TimeModel, Type
from rvmon.trace.schema import Kind

Bounds = tuple[float, float]
"""The least and the greatest that a figure can be."""

Pass = Callable[[], Any]
"""Goes over all rows once, and gives what it found."""


def spec_of(workload: Workload) -> Spec:
    """A formula as it is owed from the first sample on, a tick between two samples."""
    owed = workload.formulas[0]
    return Spec(
        CheckedSpec(
            name="cost",
            title="",
            time=TimeModel.SAMPLED,
            signals={name: Signal(name, Type(Kind.REAL)) for name in workload.columns},
            events={},
            requirements={"R": Requirement("R", Mode.UPON, BoundAtom(Bound.START), owed)},
        )
    )


def online(step: Callable[[Any, Any], Any], rows: Sequence[tuple[Any, Any]]) -> None:
    """Take all rows; what is returned is let go of."""
    for t, values in rows:
        step(t, values)


def passes(workload: Workload, sentil: Any) -> dict[str, Pass]:
    """By name, all that is timed."""
    spec, columns = spec_of(workload), workload.columns
    count = len(next(iter(columns.values())))
    names = [*columns]
    ours = [(t, {name: columns[name][t] for name in names}) for t in range(count)]
    text = translate(workload.formulas[0], dialects.SENTIL)
    parsed = sentil.parse(text)
    places = sentil.OnlineMonitor(parsed)
    order = sorted(names, key=lambda name: places.symbol_index(spelling(name)))
    theirs = [(float(t), [float(columns[name][t]) for name in order]) for t in range(count)]
    named = {spelling(name): [float(value) for value in columns[name]] for name in names}
    trace = sentil.Trace([float(t) for t in range(count)], named)
    arrays = {"t_ns": np.arange(count), **{name: np.array(columns[name]) for name in names}}

    def stepped(*, streams: bool) -> Pass:
        return lambda: online(spec.robustness_monitor(streams=streams).step_ns, ours)

    return {
        "SENTIL online": lambda: online(sentil.OnlineMonitor(parsed).update_packed, theirs),
        "attempt": stepped(streams=False),
        "stream": stepped(streams=True),
        "SENTIL offline": lambda: parsed.robustness_signal(trace),
        "offline": lambda: spec.robustness(arrays).streams["R"],
    }


def figures(workload: Workload, *, streams: bool) -> dict[int, Bounds]:
    """What a monitor says of each position."""
    monitor = spec_of(workload).robustness_monitor(streams=streams)
    names = [*workload.columns]
    found = []
    for t, row in enumerate(zip(*workload.columns.values(), strict=True)):
        found += monitor.step_ns(t, dict(zip(names, row, strict=True)))
    found += monitor.finish()
    return {one.t: (one.robustness.low, one.robustness.high) for one in found}


def differences(workload: Workload, found: dict[str, Any]) -> tuple[int, int]:
    """How many figures were compared with those of SENTIL, and how many differ.

    It counts a window that the trace cuts short as it is; ours is then no single number.
    """
    signal = np.asarray(found["SENTIL offline"].tolist())
    offline = found["offline"]
    sure = np.flatnonzero(offline.low == offline.high).tolist()
    told = [{t: (one.low, one.high) for t, one in offline}]
    told += [figures(workload, streams=streams) for streams in (True, False)]
    compared = wrong = 0
    for own in told:
        shared = [t for t in sure if t in own]
        compared += len(shared)
        wrong += sum(own[t] != (signal[t], signal[t]) for t in shared)
    return compared, wrong


def timed(run: Pass, rows: int) -> tuple[float, Any]:
    """Nanoseconds of the processor per row, and what a pass found."""
    began = time.process_time_ns()
    found = run()
    return (time.process_time_ns() - began) / rows, found


def main(argv: list[str]) -> int:
    """Print the table; exits 1 if a figure differs."""
    parser = argparse.ArgumentParser(description="What robustness costs per sample.")
    parser.add_argument("--rows", type=int, default=20_000)
    parser.add_argument("--repeats", type=int, default=7)
    options = parser.parse_args(argv)
    try:
        sentil = importlib.import_module("sentil")
    except ImportError as error:
        print(f"sentil is missing: {error}")
        return 0
    failed = False
    for workload in unsteady(options.rows):
        runs = passes(workload, sentil)
        spent: dict[str, list[float]] = {name: [] for name in runs}
        found: dict[str, Any] = {name: run() for name, run in runs.items()}  # all is made ready
        for _ in range(options.repeats):
            for name, run in runs.items():
                spent[name].append(timed(run, options.rows)[0])
        compared, wrong = differences(workload, found)
        failed = failed or wrong > 0
        cells = (f"{n} {min(own):.0f}/{statistics.median(own):.0f}" for n, own in spent.items())
        print(
            f"{workload.name}: {', '.join(cells)}; compared {compared}, differ {wrong}", flush=True
        )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
