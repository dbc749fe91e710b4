"""What a sample costs where compiled C takes some requirements of a monitor and Python the others.

    python -m benchmarks.mixed [--rows 10000]

Ten requirements on ten signals, alone and with one more that C does not take; `auto` without and
with what was prepared. Samples of one value, where every 250th concerns that requirement, or every
second; and rows of all values, where those that it reads stay the same, or change too. Processor
time of `step`, all in, the least of three passes. The verdicts and instants are compared.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence

from benchmarks.kinds import PREPARED, measured

from rvmon import loads
from rvmon.trace.sample import Value

TEN = range(10)

OTHERS = {
    "none": "",
    "let": "upon go then within 3 s y >= a let a = y",
    "for each": "upon req.id = k then within 3 s ack.id = k for each k in req.id",
    "root": "always sqrt(y) < 100",
    "no bounds": "upon p then F[2 s, 5 s] (q and (F q) and F[1 s, 9 s] always p)",
}

TRAFFIC = ("one value, rarely", "one value, often", "rows, same", "rows, changed")


def text_of(other: str) -> str:
    """A specification with one more requirement."""
    lines = [f"signal {', '.join(f'x{n}' for n in TEN)}, y : real", "signal p, q : bool"]
    lines += ["event go", "event req(id : int)", "event ack(id : int)"]
    lines += [f"requirement P{n}\n  upon x{n} > 9 then within 3 s x{n} < 5" for n in TEN]
    return "\n".join(["spec s", *lines, f"requirement R\n  {other}" if other else ""]) + "\n"


def rows_of(traffic: str, count: int) -> Iterator[dict[str, Value]]:
    """Samples a second apart; the first one has all signals."""
    yield {**{f"x{n}": 1.0 for n in TEN}, "y": 1.0, "p": False, "q": False}
    events: dict[int, dict[str, Value]] = {0: {"go": True}, 1: {"req": {"id": 1}}}
    events[2] = {"ack": {"id": 1}}
    for i in range(count):
        event = events.get(i // 250 % 3, {}) if i % 250 == 0 else {}
        if traffic.startswith("rows"):
            held = i // 250 if traffic.endswith("same") else i % 17
            yield {**{f"x{n}": (i + n) * 7 % 11 / 1 for n in TEN}, "y": float(held), **event}
        elif i % 2 and traffic.endswith("often"):
            yield {"y": float(i % 17)}
        else:
            yield event or {f"x{i % 10}": i * 7 % 11 / 1}


def main(argv: Sequence[str]) -> int:
    """Measure and print; 1 if two engines differ."""
    parser = argparse.ArgumentParser(description="Monitors that C takes in part.")
    parser.add_argument("--rows", type=int, default=10_000)
    options = parser.parse_args(argv)
    differ = 0
    print("| beside ten | " + " | ".join(TRAFFIC) + " |\n|---|" + "---|" * len(TRAFFIC))
    for name, other in OTHERS.items():
        cells = []
        for traffic in TRAFFIC:
            rows = [*rows_of(traffic, options.rows)]
            with tempfile.TemporaryDirectory() as folder:  # in which nothing is prepared yet
                os.environ["XDG_CACHE_HOME"] = folder
                found = [
                    measured(loads(text_of(other)), engine, rows, 9.0)
                    for engine in ("auto", PREPARED)
                ]
            differ += found[0][1] != found[1][1]
            cells.append(" → ".join(f"{cost:,.0f}" for cost, _ in found) + " ns")
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
