r"""Ours against something independent on random cases: one command line, one table.

    python -m benchmarks.differential verdicts --count 100000 --seed 1 --jobs 2
    python -m benchmarks.differential verdicts --set "forms=c,c rows,c+next" traces=8 outages=100
    python -m benchmarks.differential fillings long --count 1000

Prints what the cases
were made of, and every disagreement with its seed; exits 1 if there is one. Ranges of numbers of
one seed hold different cases: runs add up. `--set` gives the settings of a comparison, and fields
of `Profile` and `TraceProfile` (rvmon.testing.generate) where it draws specifications and traces.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any, get_type_hints

import msgspec
from benchmarks.comparisons import doors, models, monitors, peers
from benchmarks.comparisons.comparison import Comparison
from benchmarks.program import program
from tests.tools.differential import Campaign

from rvmon.execute.parallel import execute

COMPARISONS: dict[str, Comparison] = {
    **monitors.COMPARISONS,
    **doors.COMPARISONS,
    **models.COMPARISONS,
    **peers.COMPARISONS,
}


def settings_of(comparison: Comparison, given: Sequence[str]) -> list[Any]:
    """The settings of a comparison with some of their fields changed.

    Raises:
        ValueError: there is no such field, or no such value.
    """
    left = dict(entry.partition("=")[::2] for entry in given)
    found = []
    for default in comparison.settings:
        hints = get_type_hints(type(default))
        own = {one.name for one in fields(default)} & left.keys()
        changed = {n: msgspec.convert(left.pop(n), hints[n], strict=False) for n in own}
        found.append(replace(default, **changed))
    if left:
        known = ", ".join(one.name for default in found for one in fields(default))
        raise ValueError(f"no setting `{next(iter(left))}`: there are {known or 'none'}")
    return found


def main(
    comparisons: Sequence[str],
    *,
    count: int = 100,
    seed: int = 1,
    from_: int = 0,
    jobs: int = 1,
    show: int = 5,
    set_: Sequence[str] = (),
) -> int:
    """Compare so many of each, from that number on, in some processes; show some disagreements."""
    if unknown := {*comparisons} - COMPARISONS.keys():
        raise SystemExit(f"no comparison `{min(unknown)}`: there are {', '.join(COMPARISONS)}")
    try:
        settings = {name: settings_of(COMPARISONS[name], set_) for name in comparisons}
    except (ValueError, msgspec.ValidationError) as error:
        raise SystemExit(str(error)) from None
    wrong = 0
    for name in comparisons:
        one, began = COMPARISONS[name], time.perf_counter()
        last = from_ + count
        parts = [range(at, min(at + one.part, last)) for at in range(from_, last, one.part)]
        begin = partial(partial, _part, one.judge, seed, settings[name])
        counts, texts = Counter[str](), list[str]()
        for found in execute(parts, begin, jobs=jobs, what="part"):
            counts += found.counts
            texts += found.disagreements
        seconds = time.perf_counter() - began
        print(f"{name}: {one.about}")
        print(f"  {count} {one.unit} from {from_} on, seed {seed}, {seconds:.0f} s")
        for what in sorted(counts):
            print(f"  {what:45} {counts[what]:>12,}")
        print(f"  {'disagreements':45} {len(texts):>12,}", flush=True)
        for text in texts[:show]:
            print(f"\n{'=' * 72}\n{text}\n")
        wrong += len(texts)
    return int(wrong > 0)


def _part(judge: Callable[..., None], seed: int, settings: list[Any], numbers: range) -> Campaign:
    found = Campaign()
    judge(found, seed, *settings, numbers)
    return found


LISTED = "\n".join(f"    {name:16} {one.about}" for name, one in COMPARISONS.items())

if __name__ == "__main__":
    sys.exit(program(f"{__doc__}\n{LISTED}", main))
