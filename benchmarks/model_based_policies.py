"""The model-based column of Table 1 for each way of choosing witnesses.

    python -m benchmarks.model_based_policies --seeds 10

The paper has R1 3/4, R2 1/4, R3 4/4, R4 4/4, R5 4/4 passed. The column depends on which witness is
taken; the campaign takes the likeliest, and the others are shown here, over several seeds, without
and with the fitted loss of signals at start-up.
"""

from __future__ import annotations

import argparse
from collections import Counter

from handover.checker import spec_path
from handover.driver import run_test
from handover.generator.model_based import model_based
from rvmon.cdv.system import Checker
from rvmon.cdv.template import PolicyName
from rvmon.session import load

POLICIES: tuple[PolicyName, ...] = ("likely", "shortest", "fastest")


def main() -> None:
    """Play all tests and print the mean number of runs that pass each requirement."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=10)
    arguments = parser.parse_args()
    for robot in ("correct", "legacy"):
        checker = Checker(load(spec_path(robot)))
        for loss in (False, True):
            for policy in POLICIES:
                passed: Counter[str] = Counter()
                for seed in range(1, arguments.seeds + 1):
                    passed += _column(checker, robot, policy, seed, startup_loss=loss)
                cells = "  ".join(
                    f"R{n} {passed[f'R{n}'] / arguments.seeds:.1f}/4" for n in range(1, 6)
                )
                print(f"{robot:8} {'loss' if loss else 'no loss':8} {policy:9} {cells}", flush=True)


def _column(
    checker: Checker, robot: str, policy: PolicyName, seed: int, *, startup_loss: bool
) -> Counter[str]:
    """How many of the four tests pass each requirement."""
    passed: Counter[str] = Counter()
    for test in model_based(4, seed, policy):
        checker.begin()
        run = run_test(test, robot=robot, startup_loss=startup_loss, observer=checker.observe)
        verdicts = checker.finish(run.end_ns).verdicts
        passed.update(name for name, verdict in verdicts.items() if verdict == "P")
    return passed


if __name__ == "__main__":
    main()
