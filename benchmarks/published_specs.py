"""Requirements that others have published: what each costs per sample.

    python -m benchmarks.published_specs [--rows 2000] [FILE …]

The files stand in `benchmarks/published`, each with its source. Samples come a second apart (at
the ticks of a clocked specification), numbers are drawn near those that the file compares with and
change at every row, conditions change in a third of the rows. Processor time of `step`, all in.
"""

from __future__ import annotations

import argparse
import random
import re
import statistics
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.kinds import measured

from rvmon import load
from rvmon.session import Spec
from rvmon.trace.sample import Value
from rvmon.trace.schema import Kind

HERE = Path(__file__).with_name("published")
_COMPARED = re.compile(r"[<>=]=? (\d+(?:\.\d+)?)(?! m?s)")


def rows_of(spec: Spec, text: str, count: int) -> list[dict[str, Value]]:
    """Samples whose numbers lie on both sides of those that a text compares with."""
    rng = random.Random("published")
    near = [float(number) for number in _COMPARED.findall(text)] or [1.0]
    rows: list[dict[str, Value]] = []
    for _ in range(count):
        row: dict[str, Value] = {}
        for name, signal in spec.checked.signals.items():
            if signal.type.kind is not Kind.BOOL:
                row[name] = rng.choice(near) + rng.choice((-1, 0, 1)) * rng.random()
            elif not rows or rng.random() < 1 / 3:
                row[name] = rng.random() < 0.5
        rows.append(row)
    return rows


def main(argv: Sequence[str]) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Published requirements.")
    parser.add_argument("--rows", type=int, default=2000)
    parser.add_argument("--seconds", type=float, default=1.0, help="for more than one pass")
    parser.add_argument("files", nargs="*", type=Path, default=sorted(HERE.glob("*.rv")))
    options = parser.parse_args(argv)
    print("| requirement | ns a sample |\n|---|---|")
    figures: list[float] = []
    for file in options.files:
        spec = load(file)
        rows = rows_of(spec, file.read_text(), options.rows)
        for name in spec.requirements:
            figures.append(measured(spec, rows, options.seconds, only=[name]))
            print(f"| {file.stem} {name} | {figures[-1]:,.0f} |", flush=True)
    print(
        f"{len(figures)} requirements, median {statistics.median(figures):,.0f} ns, "
        f"most {max(figures):,.0f} ns"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
