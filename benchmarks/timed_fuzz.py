"""Damaged models of both text forms: each is read or refused, none makes a traceback.

    python -m benchmarks.timed_fuzz --inputs 20000

Prints how many were refused with a finding, how many could be checked, the slowest, and every
input at which something else than a finding came out.
"""

from __future__ import annotations

import argparse
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path
from random import Random

from tests.tools.timed_damage import damaged, survives
from tests.tools.timed_generate import random_model

from rvmon.export.uppaal import uppaal_xml
from rvmon.timed.language.load import loads_network

ROOT = Path(__file__).parents[1]


def corpus() -> list[bytes]:
    """The textbook models, the handover, and small random models in both forms."""
    files = [
        *sorted(p for p in (ROOT / "examples" / "models").iterdir() if p.suffix in (".ta", ".xml")),
        ROOT / "src/handover/model/handover.ta",
    ]
    small = [random_model(seed) for seed in range(20)]
    forms = [*small, *(uppaal_xml(loads_network(text)) for text in small)]
    return [*(path.read_bytes() for path in files), *(text.encode() for text in forms)]


def main() -> int:
    """Damage, read, print, and return 1 if anything but a finding came out."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--inputs", type=int, default=20_000)
    parser.add_argument("--first", type=int, default=0, help="seed of the first input")
    arguments = parser.parse_args()
    models = corpus()
    ends: Counter[str] = Counter()
    slowest, began = (0.0, 0), time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model"
        for seed in range(arguments.first, arguments.first + arguments.inputs):
            random = Random(seed)
            path.write_bytes(damaged(random.choice(models), random, models))
            start = time.perf_counter()
            try:
                ends[survives(path)] += 1
            except Exception:  # noqa: BLE001 - this is what is looked for
                ends["traceback"] += 1
                kept = Path(f"damaged-{seed}")
                kept.write_bytes(path.read_bytes())
                print(f"{kept}:\n{traceback.format_exc(limit=-3)}", flush=True)
            slowest = max(slowest, (time.perf_counter() - start, seed))
    print(f"{arguments.inputs} inputs, {time.perf_counter() - began:.0f} s")
    for end in ("refused", "stopped", "checked", "traceback"):
        print(f"  {end:10} {ends[end]:6}")
    print(f"slowest: {slowest[0]:.1f} s, input {slowest[1]}")
    return int(ends["traceback"] > 0)


if __name__ == "__main__":
    raise SystemExit(main())
