"""Simulated runs against the handover network: how many conform, which mutants are rejected.

    python -m benchmarks.handover_conformance --tests 20

Every run of the correct robot should conform; a mutant is rejected if some run of it does not.
"""

from __future__ import annotations

import argparse
import time

from handover.checker.conformance import check_run
from handover.driver import run_test
from handover.generator.abstract_test import AbstractTest, directed
from handover.generator.model_based import model_based
from handover.generator.pseudorandom import constrained, pseudorandom
from handover.model import handover_network
from handover.robot.mutants import MUTATIONS
from rvmon.timed.model.network import Network


def main() -> int:
    """Play, compare, print; 1 if a run of the correct robot does not conform."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tests", type=int, default=20, help="of each random strategy")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    count, seed = arguments.tests, arguments.seed
    network = handover_network()
    began = time.perf_counter()
    own = [test for test in directed() if test.mutation is None and test.robot != "legacy"]
    groups = {
        "pseudorandom": pseudorandom(count, seed),
        "constrained": constrained(count, seed),
        "model-based": model_based(4, seed),
        "directed": own,
    }
    diverging = 0
    for name, tests in groups.items():
        bad = [test for test in tests if not _conforms(network, test, None)]
        diverging += len(bad)
        print(f"{name:14} {len(tests) - len(bad)} of {len(tests)} runs conform", flush=True)
        for test in bad:
            print(f"    not: {test.name}")
    hunters = (*model_based(4, seed), *constrained(3, seed), *pseudorandom(3, seed))
    rejected = 0
    for mutation in MUTATIONS:
        killer = next((t.name for t in hunters if not _conforms(network, t, mutation)), None)
        rejected += killer is not None
        print(
            f"mutant {mutation:20} {f'rejected by {killer}' if killer else 'accepted'}", flush=True
        )
    print(f"{rejected} of {len(MUTATIONS)} mutants rejected; {time.perf_counter() - began:.0f} s")
    return int(diverging > 0)


def _conforms(network: Network, test: AbstractTest, mutation: str | None) -> bool:
    run = run_test(test, robot="correct", mutation=mutation, startup_loss=False)
    return bool(check_run(network, run).conforms)


if __name__ == "__main__":
    raise SystemExit(main())
