r"""Compare rvmon with something independent on random cases.

    python -m benchmarks.differential verdicts --count 100000 --seed 1 --jobs 2
    python -m benchmarks.differential verdicts --set "forms=c,c rows,c+next" traces=8 outages=100
    python -m benchmarks.differential fillings long --count 1000

Prints what the cases contained, the number of disagreements, and some of them with their seeds;
exits 1 if there is one. Different seeds give different cases, so runs add up. `--set` changes the
settings of a comparison; if it draws specifications and traces, also fields of `Profile` and
`TraceProfile` (rvmon.testing.generate).
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import is_dataclass, replace
from functools import partial
from inspect import signature
from typing import Any, get_type_hints

import msgspec
from benchmarks.comparisons import coverage, doors, long_traces, models, monitors, peers
from benchmarks.program import program
from tests.tools.differential import Campaign

from rvmon.errors import RvmonError
from rvmon.execute.parallel import execute

Judge = Callable[..., None]
"""Adds the results of a range of cases to a `Campaign`, from a seed and named settings, perhaps in
another process. The first line of its docstring says what it compares."""

_SPECS = "specifications"
_ASKED = "formulas for each way to ask"
COMPARISONS: dict[str, tuple[Judge, str, int]] = {
    "verdicts": (monitors.judge_verdicts, _SPECS, 25),
    "robustness": (monitors.judge_robustness, f"{_SPECS} of 8 traces", 25),
    "coverage": (coverage.judge_hits, f"{_SPECS} of {coverage.EACH} traces", 25),
    "long": (long_traces.judge_long, "traces", 1),
    "forecasts": (monitors.judge_forecasts, "formulas", 25),
    "fillings": (monitors.judge_fillings, "runs", 25),
    "damage": (doors.judge_damage, "inputs", 500),
    "doors": (doors.judge_doors, f"{_SPECS} of up to {doors.EACH} recordings", 25),
    "networks": (models.judge_queries, "networks", 25),
    "logics": (models.judge_logics, "networks", 25),
    "peers": (peers.judge_verdicts, _ASKED, 250),
    "peers-robustness": (peers.judge_robustness, _ASKED, 250),
}
"""For each comparison: its function, the unit that is numbered, and the number per task."""

SHOWN = 5
"""The number of disagreements that are printed."""


def settings_of(judge: Judge, given: Sequence[str]) -> dict[str, Any]:
    """The settings of a comparison, with the given values; for dataclasses, of their fields.

    Raises:
        ValueError: a setting is unknown, or a value not of its type (`ValidationError`).
    """
    left = dict(entry.partition("=")[::2] for entry in given)
    found: dict[str, Any] = {}
    known = list[str]()

    def changed(hints: dict[str, Any]) -> dict[str, Any]:
        known.extend(hints)
        own = hints.keys() & left.keys()
        return {name: msgspec.convert(left.pop(name), hints[name], strict=False) for name in own}

    for name, one in signature(judge, eval_str=True).parameters.items():
        if is_dataclass(one.default) and not isinstance(one.default, type):
            found[name] = replace(one.default, **changed(get_type_hints(one.annotation)))
        elif one.kind is one.KEYWORD_ONLY:
            found |= changed({name: one.annotation})
    if left:
        told = ", ".join(known) or "none"
        raise ValueError(f"no setting `{next(iter(left))}`: there are {told}")
    return found


def main(
    comparisons: Sequence[str],
    *,
    count: int = 100,
    seed: int = 1,
    jobs: int = 1,
    set_: Sequence[str] = (),
) -> int:
    """Run each comparison on `count` cases, in `jobs` processes; show some disagreements."""
    if unknown := {*comparisons} - COMPARISONS.keys():
        raise SystemExit(f"no comparison `{min(unknown)}`: there are {', '.join(COMPARISONS)}")
    try:
        settings = {name: settings_of(COMPARISONS[name][0], set_) for name in comparisons}
    except (ValueError, msgspec.ValidationError) as error:
        raise SystemExit(str(error)) from None
    wrong = 0
    for name in comparisons:
        (judge, unit, part), began = COMPARISONS[name], time.perf_counter()
        parts = [range(at, min(at + part, count)) for at in range(0, count, part)]
        begin = partial(partial, _part, judge, seed, settings[name])
        counts, texts = Counter[str](), list[str]()
        try:
            for found in execute(parts, begin, jobs=jobs, what="part"):
                counts += found.counts
                texts += found.disagreements
        except RvmonError as error:
            raise SystemExit(str(error)) from None
        seconds = time.perf_counter() - began
        print(f"{name}: {_about(judge)}")
        print(f"  {count} {unit}, seed {seed}, {seconds:.0f} s")
        for what in sorted(counts):
            print(f"  {what:45} {counts[what]:>12,}")
        print(f"  {'disagreements':45} {len(texts):>12,}", flush=True)
        for text in texts[:SHOWN]:
            print(f"\n{'=' * 72}\n{text}\n")
        wrong += len(texts)
    return int(wrong > 0)


def _part(judge: Judge, seed: int, settings: dict[str, Any], numbers: range) -> Campaign:
    found = Campaign()
    judge(found, seed, numbers, **settings)
    return found


def _about(judge: Judge) -> str:
    return (judge.__doc__ or "").splitlines()[0].rstrip(".")


LISTED = "\n".join(f"    {name:16} {_about(one)}" for name, (one, *_) in COMPARISONS.items())

if __name__ == "__main__":
    sys.exit(program(f"{__doc__}\n{LISTED}", main))
