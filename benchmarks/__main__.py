"""The benchmarks, one for each question: `python -m benchmarks NAME …`, or `… NAME --help`."""

from __future__ import annotations

import runpy
import sys
from collections.abc import Sequence

BENCHMARKS = {
    "online": "what a sample costs, beside all peers: forms, inputs, many monitors, robustness",
    "recordings": "what a file costs: columns, whole processes, large, many and odd files",
    "growth": "how cost grows: hard streams, large inputs, requirements, tests, automata",
    "differential": "ours against something independent, on random cases",
    "peers": "what other monitors say of the same formulas, and of the same faults",
    "core_mutants": "does the core's C hold a line that no test needs?",
    "models": "the model checker: states and time, and whose models it reads",
    "table1": "Table 1 over many seeds, and whether runs conform to the model",
    "testbench": "faults that are seen, holes that are closed, failures that are shrunk",
    "endurance": "a monitor that lives long, and processes that are killed",
    "claims": "do the claims of docs/claims.md hold?",
    "results": "the page of results: online, recordings, hard streams",
}


def main(argv: Sequence[str]) -> int:
    if not argv or argv[0] not in BENCHMARKS:
        print(f"{__doc__}\n")
        print("\n".join(f"  {name:14}{about}" for name, about in BENCHMARKS.items()))
        return 0 if not argv or argv[0] in ("-h", "--help") else 2
    sys.argv = [f"python -m benchmarks.{argv[0]}", *argv[1:]]
    runpy.run_module(f"benchmarks.{argv[0]}", run_name="__main__", alter_sys=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
