"""States and time of the model checker on textbook networks and on the handover.

    python -m benchmarks.timed_models

Prints symbolic states visited and stored, seconds of CPU (the best of some runs) and states per
second; beside them what TChecker (compiled, C++) took for its own models of the same systems.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from handover.model import handover_network
from rvmon.timed.language.load import load_network
from rvmon.timed.model.network import Network
from rvmon.timed.search.outcome import Outcome
from rvmon.timed.search.verify import verify

MODELS = Path(__file__).parents[1] / "examples" / "models"

PEER = {
    ("fischer", 4): (220, None),
    ("fischer", 5): (727, 0.0087),
    ("fischer", 6): (2_378, 0.046),
    ("fischer", 7): (7_737, 0.23),
    ("train_gate", 4): (1_652, 0.0055),
    ("train_gate", 5): (10_705, 0.042),
    ("train_gate", 6): (77_730, 0.44),
}
"""TChecker's states (Fischer: stored; trains: visited, of another train model) and seconds."""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=3, help="runs of each, the best counts")
    arguments = parser.parse_args()
    print(f"{'model':24} {'visited':>9} {'stored':>9} {'seconds':>9} {'states/s':>9}   TChecker")
    for (model, size), (states, seconds) in PEER.items():
        network = load_network(MODELS / f"{model}.ta", constants={"N": size})
        peer = f"{states:,} states" + (f", {seconds} s" if seconds is not None else "")
        _print(f"{model} {size}", *_best(network, "exclusion", arguments.repeat), peer)
    network = handover_network()
    for query in network.queries:
        _print(f"handover {query.id}", *_best(network, query.id, arguments.repeat), "")


def _best(network: Network, query_id: str, repeat: int) -> tuple[Outcome, float]:
    (query,) = (query for query in network.queries if query.id == query_id)
    seconds = []
    for _ in range(repeat):
        began = time.process_time()
        outcome = verify(network, query)
        seconds.append(time.process_time() - began)
    return outcome, min(seconds)


def _print(name: str, outcome: Outcome, seconds: float, peer: str) -> None:
    cost = outcome.statistics
    figures = f"{cost.visited:9,} {cost.stored:9,} {seconds:9.3f} {cost.visited / seconds:9,.0f}"
    print(f"{name:24} {figures}   {peer}".rstrip(), flush=True)


if __name__ == "__main__":
    main()
