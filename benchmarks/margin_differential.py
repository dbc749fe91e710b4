r"""Robustness, by every way that measures it, against its oracle on random specs and traces.

    python -m benchmarks.margin_differential --pairs 10000 --seed 1

`samples` is the monitor that is stepped, `arrays` what measures a recording in columns. Prints how
much was compared and every disagreement, shrunk; exits 1 if there is one.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter

from benchmarks.differential import FEATURES, MODELS, profile_of
from benchmarks.margin_ways import WAYS, Way
from tests.tools.differential import cases_of
from tests.tools.judgement import Judgement
from tests.tools.shrink import shrink

from rvmon.errors import RvmonError
from rvmon.session import Spec
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.testing.case import Case, show_case
from rvmon.testing.generate.trace import TraceProfile
from rvmon.testing.law.margins import margins


class Specs:
    """Specifications that are compiled once for all cases and ways in a row."""

    def __init__(self) -> None:
        self._last: Spec | None = None

    def __call__(self, checked: CheckedSpec) -> Spec:
        """The specification."""
        if self._last is None or self._last.checked is not checked:
            self._last = Spec(checked)
        return self._last


def differences(case: Case, way: Way, specs: Specs) -> list[str] | None:
    """How the figures of a way depart from the oracle's; `None` if the case has no samples."""
    try:
        case = way.adapted(case)
        if not case.samples:
            return None
        found = way.measure(specs(case.spec), case)
    except Exception as error:  # noqa: BLE001 - whatever it raises is a finding
        return [f"raised {type(error).__name__}: {error}"]
    judgement = Judgement(case)
    expected = margins(judgement.followings, judgement.outcomes)
    return [
        f"{key}: {found.get(key)}, expected {expected.get(key)}"
        for key in sorted({*expected, *found})
        if found.get(key) != expected.get(key)
    ]


def shrunk(case: Case, way: Way) -> str:
    """A small case that shows a difference, as text."""
    specs = Specs()

    def disagree(smaller: Case) -> bool:
        try:
            return bool(differences(smaller, way, specs))
        except RvmonError:  # the smaller case is none that the law speaks of
            return False

    small = shrink(case, disagree)
    found = differences(small, way, specs) or ()
    return "\n".join([*found, show_case(way.adapted(small))])


def main(argv: list[str]) -> int:
    """Run the campaign and print its figures."""
    parser = argparse.ArgumentParser(description="Our robustness against its oracle.")
    parser.add_argument("--pairs", type=int, default=1_000)
    parser.add_argument("--traces", type=int, default=8, help="of the pairs with one spec")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--way", nargs="+", choices=WAYS, default=[*WAYS])
    parser.add_argument("--time", choices=MODELS, help="default: all time models, in turn")
    parser.add_argument("--depth", type=int, default=4)
    parser.add_argument("--many", type=int, default=8, metavar="PERCENT")
    parser.add_argument("--crowded", type=int, default=0, metavar="PERCENT")
    parser.add_argument("--wide", type=int, default=0, metavar="PERCENT")
    parser.add_argument("--amounts", type=int, default=12, metavar="N")
    parser.add_argument("--without", nargs="*", choices=FEATURES, default=[], metavar="FEATURE")
    parser.add_argument("--known", action="store_true", help="no unknown values in the traces")
    parser.add_argument("--show", type=int, default=3, help="disagreements printed at most")
    options = parser.parse_args(argv)
    profile = profile_of(options)
    traces = TraceProfile(unknowns=not options.known)
    measured: Counter[str] = Counter()
    wrong: Counter[str] = Counter()
    texts: list[str] = []
    began = time.perf_counter()
    specs = Specs()
    seeds = (f"margins {options.seed}/{n}" for n in range(options.pairs // options.traces))
    cases = (one for seed in seeds for one in cases_of(seed, profile, traces, options.traces))
    for number, case in enumerate(cases):
        for name in options.way:
            found = differences(case, WAYS[name], specs)
            measured[name] += found is not None
            if found:
                wrong[name] += 1
                if len(texts) < options.show:
                    texts.append(f"{name}, pair {number}\n{shrunk(case, WAYS[name])}")
    print(f"seed {options.seed}, pairs {options.pairs}, {time.perf_counter() - began:.0f} s")
    for name in options.way:
        refused = options.pairs - measured[name]
        print(f"{name:8} measured {measured[name]}, refused {refused}, wrong {wrong[name]}")
    print("".join(f"\n{'=' * 72}\n{text}\n" for text in texts), end="")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
