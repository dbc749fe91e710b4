"""Attempts held open: what a sample costs, and a byte count per attempt. No peer keeps attempts."""

from __future__ import annotations

import statistics
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.contenders import OURS
from benchmarks.peers.client import Peer, PeerError

import rvmon
from rvmon.monitor import compile_spec

SPEC = """spec open
time held
signal answered, other : bool input
event asked input
requirement R1
  upon asked
  then within 1 h answered
"""


@dataclass(frozen=True, slots=True)
class OpenAttempts:
    """What it costs to keep attempts open.

    Attributes:
        attempts: so many are open.
        median: CPU ns per sample that concerns none of them.
        least: of the repeats.
        most: of the repeats.
        size: bytes of memory per attempt, the median.
    """

    attempts: int
    median: float
    least: float
    most: float
    size: float


def measure_open(
    repeats: int,
    counts: Sequence[int] = (1, 10, 100, 1_000, 10_000, 100_000),
    samples: int = 2_000,
    seconds: float = 10,
) -> Iterator[OpenAttempts]:
    """Measure for each count, each time in a new process.

    Args:
        repeats: of each count.
        counts: of open attempts.
        samples: measured with so many open.
        seconds: which opening them may take.

    Raises:
        PeerError: it takes longer, and what was measured before has been given out; or the
            compiler does not promise that so many cost no more than one.
    """
    requirement = compile_spec(rvmon.loads(SPEC).checked).requirements["R1"]
    if not requirement.in_runs(requirement.automaton):
        raise PeerError("the compiler has not proved that open attempts can be kept in runs")
    for count in counts:
        spent: list[float] = []
        sizes: list[float] = []
        for _ in range(repeats):
            with Peer(Path(sys.executable), OURS) as peer:
                answer = peer.ask(
                    "hold_open", spec=SPEC, attempts=count, samples=samples, seconds=seconds
                )
            if answer["open"] != count:
                raise PeerError(
                    f"{answer['open']:,} of {count:,} were open after {seconds:g} seconds"
                )
            spent.append(answer["cpu_ns"] / samples)
            sizes.append(answer["bytes"])
        yield OpenAttempts(
            count, statistics.median(spent), min(spent), max(spent), statistics.median(sizes)
        )
