r"""Ours against something independent on random cases: one command line, one table.

    python -m benchmarks.differential verdicts --count 100000 --seed 1 --jobs 2
    python -m benchmarks.differential verdicts --set "forms=c,c rows,c+next" traces=8 outages=100
    python -m benchmarks.differential fillings long --count 1000

`python -m benchmarks.differential --help` lists what is compared with what. Prints what the cases
were made of, and every disagreement with its seed; exits 1 if there is one. Ranges of numbers of
one seed hold different cases: runs add up. `--set` gives the settings of a comparison, and fields
of `Profile` and `TraceProfile` (rvmon.testing.generate) where it draws specifications and traces.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any, get_type_hints

import msgspec
from benchmarks.comparisons import doors, models, monitors, peers
from benchmarks.comparisons.comparison import Comparison

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


def parse(argv: Sequence[str]) -> tuple[argparse.Namespace, dict[str, list[Any]]]:
    """The command line, and the settings of each comparison."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.differential",
        description="Ours against something independent, on random cases.",
        epilog="\n".join(f"{name:16} {one.about}" for name, one in COMPARISONS.items()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("comparisons", nargs="+", choices=COMPARISONS, metavar="COMPARISON")
    parser.add_argument("--count", type=int, default=100, help="of each comparison")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--from", type=int, default=0, dest="first", metavar="N")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--show", type=int, default=5, help="disagreements that are printed")
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE", dest="given")
    options = parser.parse_args(argv)
    try:
        return options, {
            name: settings_of(COMPARISONS[name], options.given) for name in options.comparisons
        }
    except (ValueError, msgspec.ValidationError) as error:
        parser.error(str(error))


def main(argv: Sequence[str]) -> int:
    options, settings = parse(argv)
    wrong = 0
    for name in options.comparisons:
        one, began = COMPARISONS[name], time.perf_counter()
        last = options.first + options.count
        starts = range(options.first, last, one.part)
        parts = [range(start, min(start + one.part, last)) for start in starts]
        begin = partial(partial, one.judge, options.seed, *settings[name])
        counts, texts = Counter[str](), list[str]()
        for counted, found in execute(parts, begin, jobs=options.jobs, what="part"):
            counts += counted
            texts += found
        seconds = time.perf_counter() - began
        print(f"{name}: {one.about}")
        print(f"  {options.count} {one.unit} from {options.first} on, seed {options.seed}", end="")
        print(f", {seconds:.0f} s")
        for what in sorted(counts):
            print(f"  {what:45} {counts[what]:>12,}")
        print(f"  {'disagreements':45} {len(texts):>12,}", flush=True)
        for text in texts[: options.show]:
            print(f"\n{'=' * 72}\n{text}\n")
        wrong += len(texts)
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
