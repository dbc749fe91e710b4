"""Cost of the model checker on textbook networks and the handover.

    python -m benchmarks.models [--seconds 60] [--repeat 3]

Prints symbolic states visited and stored, CPU seconds (the least of some searches) and bytes of
memory for each stored state. Each network is searched in a separate process.
"""

from __future__ import annotations

import resource
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

from benchmarks.program import program

from handover.model import handover_network
from rvmon.models.language.elaborate import query_on
from rvmon.models.language.load import load_network
from rvmon.models.network import Network, Query
from rvmon.models.search.budget import Budget, Statistics
from rvmon.models.search.verify import verify

HERE = Path(__file__).parent
MODELS = HERE.parent / "examples" / "models"
COLLISION = "E<> Station(1).Transm and Station(2).Transm and Bus.Idle"
"""The query of CSMA/CD as in TChecker; the query of the model compares clocks."""

SIZES = {"fischer": (7, 8, 9, 10), "csma_cd": (7, 8, 9), "train_gate": (5, 6), "fddi": (5, 8, 10)}


def cost(*, repeat: int = 3, seconds: float = 60.0) -> None:
    """Search textbook networks and the handover `repeat` times, at most `seconds` each."""
    print(f"{'query':22} {'visited':>10} {'stored':>10} {'seconds':>9} {'B/state':>8}")
    for name, size in [*((n, s) for n, sizes in SIZES.items() for s in sizes), ("handover", 0)]:
        for query, holds, told, held in _searched(name, size, repeat, seconds):
            label = f"{name} {size or query}"
            shown = f"{held:8.0f}" if size and told.stored > 5_000 else f"{'':8}"
            figures = f"{told.visited:10,} {told.stored:10,} {told.seconds:9.3f} {shown}"
            unknown = "   not decided" if holds is None else ""
            print(f"{label:22} {figures}{unknown}".rstrip(), flush=True)


Search = tuple[str, bool | None, Statistics, float]
"""A query, whether it holds, its statistics with CPU seconds, bytes per stored state."""


def _searched(name: str, size: int, repeat: int, seconds: float) -> list[Search]:
    """The cost of the queries of a network, measured in a new process."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        return pool.submit(_search, name, size, repeat, seconds).result()


def _search(name: str, size: int, repeat: int, seconds: float) -> list[Search]:
    found = []
    for network, query in _queries(name, size):
        before, times = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, []
        for _ in range(repeat):
            began = time.process_time()
            outcome = verify(network, query, budget=Budget(seconds=seconds))
            times.append(time.process_time() - began)
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        told = replace(outcome.statistics, seconds=min(times))
        found.append((query.id, outcome.holds, told, 1024 * grown / told.stored))
    return found


def _queries(name: str, size: int) -> list[tuple[Network, Query]]:
    if name == "handover":
        network = handover_network()
        return [(network, query) for query in network.queries]
    folder, suffix = HERE if name == "fddi" else MODELS, ".xml" if name == "csma_cd" else ".ta"
    network = load_network(folder / f"{name}{suffix}", constants={"N": size})
    if name == "csma_cd":
        return [(network, query_on(network, COLLISION)[1])]
    return [(network, network.queries[0])]


if __name__ == "__main__":
    sys.exit(program(__doc__, cost))
