r"""Green never hides a failure: what was lost is filled in, and no verdict may turn.

    python -m benchmarks.soundness --runs 20000 --fillings 8 --seed 1 --workers 2
    python -m benchmarks.soundness --runs 20000 --outages --time sampled

A run's P or NT that becomes F, or its F that becomes anything else, is printed; exits 1 if there is
one. With outages every other run lost nothing else: those may ask what is known, too.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from functools import partial

from tests.tools.differential import case_of
from tests.tools.law import judge
from tests.tools.sound import Tried, is_spoken_of, narrowed, overturned

from rvmon.execute.parallel import execute
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.case import Case, show_case, show_spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile


def try_seed(
    seed: str,
    fillings: int,
    profile: Profile,
    *,
    outages: bool,
    alone: bool,
    about: str = "",
    samples: int = 12,
) -> tuple[Case, Tried] | None:
    """Fill in what the case of a seed lost; `None` if the law does not speak of it.

    Args:
        seed: of the case and of the fillings.
        fillings: so many are tried.
        profile: of the specification.
        outages: whether stretches of time are lost.
        alone: whether nothing else is.
        about: what the specification has to hold, as text.
        samples: at most so many.
    """
    profile = replace(profile, stale=not alone)
    lost = 100 if outages else 0
    traces = TraceProfile(samples=samples, unknowns=not alone, outages=lost)
    case = narrowed(case_of(seed, profile, traces))
    if about not in show_spec(case.spec) or not (alone or is_spoken_of(case.spec)):
        return None
    rng = random.Random(seed)
    return case, overturned(rng, case, fillings, judge, whole=not alone)


def run_part(options: argparse.Namespace, seeds: Iterable[str]) -> tuple[Counter[str], list[str]]:
    """Try the cases of some seeds; runs in a worker."""
    counts: Counter[str] = Counter()
    found: list[str] = []
    time = TimeModel(options.time) if options.time else None
    profile = Profile(requirements=1, time=time, depth=options.depth)
    for number, seed in enumerate(seeds):
        alone = options.outages and number % 2 == 1
        tried = try_seed(
            seed,
            options.fillings,
            profile,
            outages=options.outages,
            alone=alone,
            about=options.about,
        )
        if tried is None:
            continue
        case, outcome = tried
        counts.update(verdict.value for verdict in outcome.verdicts.values())
        counts["split"] += outcome.is_split
        if outcome.overturning is not None:
            before = ", ".join(verdict.value for verdict in outcome.verdicts.values())
            lines = [f"seed {seed}: {before}", show_case(case)]
            found.append("\n".join([*lines, "filled in:", show_case(outcome.overturning)]))
    return counts, found


def main(argv: list[str]) -> int:
    """Run the campaign and print its figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--runs", type=int, default=1_000)
    parser.add_argument("--fillings", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--time", choices=[model.value for model in TimeModel])
    parser.add_argument("--outages", action="store_true")
    parser.add_argument("--depth", type=int, default=4, help="of the deepest consequent")
    parser.add_argument("--about", default="", help="only specifications that hold this text")
    options = parser.parse_args(argv)
    seeds = [f"{options.seed}/{number}" for number in range(options.runs)]
    parts = [seeds[start : start + 50] for start in range(0, len(seeds), 50)]
    counts: Counter[str] = Counter()
    found: list[str] = []
    begin = partial(partial, run_part, options)
    for counted, overturning in execute(parts, begin, jobs=options.workers, what="part"):
        counts += counted
        found += overturning
    split = counts.pop("split", 0)
    shown = ", ".join(f"{name} {n}" for name, n in sorted(counts.items()))
    print(f"runs {counts.total()} (of {options.runs}; the others are not spoken of), {shown}")
    print(f"{options.fillings} fillings each, with and without a failure in {split} runs")
    print(f"overturned {len(found)}")
    for text in found[:3]:
        print("\n" + "=" * 72 + "\n" + text)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
