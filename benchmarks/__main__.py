"""The benchmarks, one for each question, as `python -m benchmarks.NAME`, or `… --help`."""

from __future__ import annotations

BENCHMARKS = {
    "results": "the page of results: samples, columns, files, robustness, beside all peers; cliffs",
    "differential": "ours against something independent, on random cases",
    "core_mutants": "does the core's C hold a line that no test needs?",
    "models": "the model checker: states and time, beside TChecker",
    "table1": "Table 1 over many seeds, and whether runs conform to the model",
    "testbench": "faults that are seen, holes that are closed, failures that are shrunk",
    "endurance": "a monitor that lives long, and processes that are killed",
    "claims": "do the claims of docs/claims.md hold?",
}

if __name__ == "__main__":
    print(f"{__doc__}\n")
    print("\n".join(f"  {name:14}{about}" for name, about in BENCHMARKS.items()))
