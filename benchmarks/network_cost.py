"""What the delay network costs per sample, by how often its inputs change.

    python -m benchmarks.network_cost

One requirement that no automaton closes for, on recordings of 1 kHz; processor time, all in.
"""

from __future__ import annotations

import random
import sys
import time

from rvmon.loading import loads

TEXT = "whenever a then F[2 s, 5 s] b"
MILLISECOND = 1_000_000
RUNS = (
    ("held", 600_000, 0.001),
    ("held", 60_000, 0.01),
    ("held", 10_000, 0.5),
    ("sampled", 10_000, 0.01),
)
"""Time model, samples, and the chance that a signal changes in one."""


def measure(model: str, samples: int, chance: float) -> tuple[float, str]:
    """Seconds of processor time for a run, and its verdict."""
    spec = loads(f"spec s\ntime {model}\nsignal a, b : bool\nrequirement R1\n  {TEXT}\n")
    monitor = spec.monitor(engine="network")
    rng = random.Random(1)
    values = {"a": False, "b": False}
    rows = []
    for _ in range(samples):
        values = {name: value ^ (rng.random() < chance) for name, value in values.items()}
        rows.append(values)
    began = time.process_time()
    for index, row in enumerate(rows):
        monitor.step_ns(index * MILLISECOND, row)
    report = monitor.finish()
    return time.process_time() - began, report.verdicts["R1"].value


def main() -> int:
    """Measure and print."""
    print(f"`{TEXT}`, 1 kHz")
    for model, samples, chance in RUNS:
        seconds, verdict = measure(model, samples, chance)
        changes = 2 * chance * samples
        print(
            f"  {model:8} {samples:7} samples, {changes:8.0f} changes: {seconds:6.2f} s, "
            f"{1e6 * seconds / samples:6.1f} us per sample, {verdict}"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
