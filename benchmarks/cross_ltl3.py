"""Forecasts of open attempts against an independent emptiness check, on random formulas.

    python -m benchmarks.cross_ltl3 --formulas 1000 --words 20
    python -m benchmarks.cross_ltl3 --formulas 1000 --words 20 --timed

After every position of random words, the verdict or the forecast of the monitor is compared with
what the tableau of `tests.tools.ltl3` says that infinite continuations leave possible. With
`--timed`, formulas have windows of a few ticks and are judged in held time; the tableau is given
them with the windows unrolled, and a forecast that the monitor does not give is counted as missed.
Prints the counts and every disagreement; exits 1 if there is one.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence

from tests.tools.generate_ltl import random_ltl, random_mtl
from tests.tools.ltl3 import Letter, Tableau, unrolled

from rvmon.session import Spec
from rvmon.spec.checked.formula import Bound, BoundAtom, Formula
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement, Signal, TimeModel, Type
from rvmon.spec.print.printer import format_formula
from rvmon.testing.generate.choices import BOOLS, Rng, chance
from rvmon.trace.schema import Kind
from rvmon.verdict.verdict import Verdict

MOST_TEMPORAL = 8
"""Formulas with more temporal operators have a tableau that takes too long."""


def main(argv: Sequence[str]) -> int:
    """Run the campaign and print its figures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--formulas", type=int, default=200)
    parser.add_argument("--words", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--timed", action="store_true", help="windows of a few ticks, held time")
    options = parser.parse_args(argv)
    began = time.perf_counter()
    tally: Counter[str] = Counter()
    found: list[str] = []
    for number, rng, formula, tableau in _questions(options.seed, options.timed, tally):
        if tally["formulas"] == options.formulas:
            break
        tally["formulas"] += 1
        spec = _spec(formula, TimeModel.HELD if options.timed else TimeModel.SAMPLED)
        for _ in range(options.words):
            word = _word(rng)
            said = [*_said(spec, word)]
            for length, ours in enumerate(said, 1):
                possible = tableau.possible(word[:length])
                wanted = next(iter(possible)) if len(possible) == 1 else None
                decided, value = ours
                tally[f"{'decided' if decided else 'forecast'} {_word_of(value)}"] += 1
                if options.timed and value is None and wanted is not None:
                    tally["missed"] += 1
                elif value is not wanted:
                    letters = " ".join("".join(sorted(x)) or "-" for x in word[:length])
                    found.append(
                        f"formula {number}: {format_formula(formula)} on {letters}: "
                        f"tableau {_word_of(wanted)}, monitor {_word_of(value)}"
                    )
    print(f"seed {options.seed}, {time.perf_counter() - began:.0f} s")
    for name, figure in sorted(tally.items()):
        print(f"  {name} {figure}")
    print(f"  disagreements {len(found)}")
    for text in found[:10]:
        print(text)
    return 1 if found else 0


def _questions(
    seed: int, timed: bool, tally: Counter[str]
) -> Iterator[tuple[int, random.Random, Formula, Tableau]]:
    number = 0
    while True:
        rng = random.Random(f"{seed}/{number}")
        number += 1
        formula = (random_mtl if timed else random_ltl)(rng, rng.randint(1, 4))
        tableau = Tableau.of(unrolled(formula), MOST_TEMPORAL)
        if tableau is None:
            tally[f"passed over, more than {MOST_TEMPORAL} temporal operators"] += 1
        else:
            yield number, rng, formula, tableau


def _spec(formula: Formula, time_model: TimeModel) -> Spec:
    signals = {name: Signal(name, Type(Kind.BOOL)) for name in BOOLS}
    requirement = Requirement("R", Mode.UPON, BoundAtom(Bound.START), formula)
    return Spec(CheckedSpec("ltl", "", time_model, signals, {}, {"R": requirement}))


def _said(spec: Spec, word: Sequence[Letter]) -> Iterator[tuple[bool, bool | None]]:
    """After every position whether the attempt is decided, and its verdict or forecast."""
    monitor = spec.monitor()
    decided: Verdict | None = None
    for t, letter in enumerate(word):
        for attempt in monitor.step_ns(t, {name: name in letter for name in BOOLS}):
            decided = attempt.verdict
        value = monitor.open[0].forecast if decided is None else decided
        yield decided is not None, None if value is None else value is Verdict.PASS


def _word(rng: Rng) -> list[Letter]:
    length = rng.randint(1, 8)
    return [frozenset(name for name in BOOLS if chance(rng, 50)) for _ in range(length)]


def _word_of(value: bool | None) -> str:
    return {True: "P", False: "F", None: "either"}[value]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
