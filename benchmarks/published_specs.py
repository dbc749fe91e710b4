"""Requirements that others have published: which engine takes each, and what it costs per sample.

    python -m benchmarks.published_specs [--rows 2000] [FILE …]

The files stand in `benchmarks/published`, each with its source. Samples come a second apart (at
the ticks of a clocked specification), numbers are drawn near those that the file compares with and
change at every row, conditions change in a third of the rows. Processor time of `step`, all in; the
verdicts and decision instants of all engines are compared. `–` where an engine refuses.
"""

from __future__ import annotations

import argparse
import random
import re
import statistics
import sys
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from benchmarks.kinds import measured

from rvmon import load
from rvmon.errors import RvmonError
from rvmon.session import Spec
from rvmon.trace.sample import Value
from rvmon.trace.schema import Kind

HERE = Path(__file__).with_name("published")
ENGINES = ("auto", "automaton", "network", "c")
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
    """Measure and print; 1 if two engines differ."""
    parser = argparse.ArgumentParser(description="Published requirements, by engine.")
    parser.add_argument("--rows", type=int, default=2000)
    parser.add_argument("--seconds", type=float, default=1.0, help="for more than one pass")
    parser.add_argument("files", nargs="*", type=Path, default=sorted(HERE.glob("*.rv")))
    options = parser.parse_args(argv)
    print("| requirement | " + " | ".join(ENGINES) + " |\n|---|" + "---|" * len(ENGINES))
    figures: dict[str, list[float]] = {engine: [] for engine in ENGINES}
    count = differ = 0
    for file in options.files:
        spec = load(file)
        rows = rows_of(spec, file.read_text(), options.rows)
        for name in spec.requirements:
            count += 1
            cells, found = [], []
            for engine in ENGINES:
                try:
                    cost, decided = measured(spec, engine, rows, options.seconds, only=[name])
                except RvmonError:
                    cells.append("–")
                    continue
                figures[engine].append(cost)
                found.append(decided)
                own = f" ({spec.engines(only=[name])[name].online})" if engine == "auto" else ""
                cells.append(f"{cost:,.0f} ns{own}")
            differ += any(one != other for one, other in pairwise(found))
            print(f"| {file.stem} {name} | " + " | ".join(cells) + " |", flush=True)
    for engine, own in figures.items():
        if own:
            print(
                f"{engine}: {len(own)} of {count} judged, median {statistics.median(own):,.0f} ns, "
                f"most {max(own):,.0f} ns"
            )
    print(f"verdicts and instants that differ between engines: {differ}")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
