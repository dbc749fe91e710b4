"""States, time and memory of the model checker on textbook networks and on the handover.

    python -m benchmarks.timed_models [--seconds 60] [--repeat 3]

Prints symbolic states visited and stored, seconds of CPU (the least of some searches) and bytes of
memory for each stored state, each network in a process of its own. Beside them stands what TChecker
(compiled, C++) took for its own models of the same systems, on the same machine, where it is known.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from pathlib import Path

from handover.model import handover_network
from rvmon.timed.language.elaborate import query_on
from rvmon.timed.language.load import load_network, loads_network
from rvmon.timed.model.network import Network, Query
from rvmon.timed.search.outcome import Budget
from rvmon.timed.search.verify import verify

MODELS = Path(__file__).parents[1] / "examples" / "models"

FDDI = """network fddi "Stations on a ring send in turn, and longer while there is time"
const int N = 3
const int SYNC = 20
const int ROUND = 50 * N
typedef int[1,N] station
chan take[station], give[station]

automaton Ring {
  clock c
  station at = 1
  location passing  invariant c <= 0
  location held
  start passing
  edge passing -> held    on take[at]!
  edge held    -> passing on give[at]?  do c = 0, at = at == N ? 1 : at + 1
}

automaton Station(const station me) {
  clock x, odd, even
  location idle_odd
  location sync_odd    invariant x <= SYNC
  location async_odd   invariant odd <= ROUND
  location idle_even
  location sync_even   invariant x <= SYNC
  location async_even  invariant even <= ROUND
  start idle_odd
  edge idle_odd   -> sync_odd   on take[me]?                                    do x = 0, even = 0
  edge sync_odd   -> async_odd  when x >= SYNC and odd < ROUND
  edge sync_odd   -> idle_even  when x >= SYNC and odd >= ROUND  on give[me]!
  edge async_odd  -> idle_even  on give[me]!
  edge idle_even  -> sync_even  on take[me]?                                    do x = 0, odd = 0
  edge sync_even  -> async_even when x >= SYNC and even < ROUND
  edge sync_even  -> idle_odd   when x >= SYNC and even >= ROUND on give[me]!
  edge async_even -> idle_odd   on give[me]!
}

query exclusion "two stations never send at once":
  A[] not (Station(1).sync_odd and Station(2).sync_odd)
"""

COLLISION = "E<> Station(1).Transm and Station(2).Transm and Bus.Idle"
"""Of CSMA/CD, as TChecker asks it: the model's own query compares clocks."""

PEER = {
    ("fischer", 7): "7,737 stored, 0.21 s",
    ("fischer", 8): "25,080 stored, 1.03 s",
    ("fischer", 9): "81,035 stored, 5.18 s",
    ("fischer", 10): "260,998 stored, 27.0 s",
    ("csma_cd", 7): "7,490 stored, 0.16 s",
    ("csma_cd", 8): "20,738 stored, 0.53 s",
    ("csma_cd", 9): "55,554 stored, 1.82 s",
}
"""TChecker 0.8 for its own models of these systems, 2026-11-27, 2 cores of a Xeon."""

SIZES = {"fischer": (7, 8, 9, 10), "csma_cd": (7, 8, 9), "train_gate": (5, 6), "fddi": (5, 8, 10)}


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=3, help="searches of each, the best counts")
    parser.add_argument("--seconds", type=float, default=60.0, help="a search gives up after these")
    parser.add_argument("--only", nargs=2, metavar=("MODEL", "SIZE"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.only:
        name, size = arguments.only
        for network, query in _queries(name, int(size)):
            _measure(network, query, arguments.repeat, arguments.seconds)
        return
    print(f"{'query':22} {'visited':>10} {'stored':>10} {'seconds':>9} {'B/state':>8}   TChecker")
    for name, size in [*((n, s) for n, sizes in SIZES.items() for s in sizes), ("handover", 0)]:
        words = [sys.executable, "-m", "benchmarks.timed_models", "--only", name, str(size)]
        words += ["--repeat", str(arguments.repeat), "--seconds", str(arguments.seconds)]
        told = subprocess.run(words, check=True, capture_output=True, text=True).stdout
        for line in told.splitlines():
            _print(name, size, json.loads(line))


def _queries(name: str, size: int) -> list[tuple[Network, Query]]:
    if name == "handover":
        network = handover_network()
        return [(network, query) for query in network.queries]
    if name == "fddi":
        network = loads_network(FDDI, name="fddi", constants={"N": size})
    else:
        suffix = ".xml" if name == "csma_cd" else ".ta"
        network = load_network(MODELS / f"{name}{suffix}", constants={"N": size})
    if name == "csma_cd":
        return [(network, query_on(network, COLLISION))]
    return [(network, network.queries[0])]


def _measure(network: Network, query: Query, repeat: int, limit: float) -> None:
    """Search some times, and print what it cost as JSON."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    seconds = []
    for _ in range(repeat):
        began = time.process_time()
        outcome = verify(network, query, budget=Budget(seconds=limit))
        seconds.append(time.process_time() - began)
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    cost = outcome.statistics
    told = {
        "query": query.id,
        "holds": outcome.holds,
        "visited": cost.visited,
        "stored": cost.stored,
        "seconds": min(seconds),
        "bytes": 1024 * grown / cost.stored,
    }
    print(json.dumps(told))


def _print(name: str, size: int, told: dict[str, float]) -> None:
    label = f"{name} {size}" if size else f"{name} {told['query']}"
    held = f"{told['bytes']:8.0f}" if size and told["stored"] > 5_000 else f"{'':8}"
    figures = f"{told['visited']:10,} {told['stored']:10,} {told['seconds']:9.3f} {held}"
    unknown = "" if told["holds"] is not None else "not decided"
    print(f"{label:22} {figures}   {PEER.get((name, size), '')}{unknown}".rstrip(), flush=True)


if __name__ == "__main__":
    main()
