"""Automata of random formulas: how many close, how large they get, how long they take.

Formulas are drawn until so many temporal operators are nested in each as was asked for; every other
is required from the start, the others `whenever p`. CPU times are of construction and reduction
together; then of forecasts, ten at most for each automaton. Exits 1 if one takes longer
than the budget of `--most` seconds.
"""

from __future__ import annotations

import argparse
import itertools
import random
import statistics
import time
from collections import Counter
from collections.abc import Iterator, Sequence

from tests.tools.build import p, requirement, start

from rvmon.language.checked.formula import Binary, Formula, Unary
from rvmon.language.checked.specification import Requirement
from rvmon.language.print import format_formula
from rvmon.logic.alphabet import alphabet_of
from rvmon.logic.automaton import PASSED, Automaton
from rvmon.logic.construct import Budget, DoesNotCloseError, construct
from rvmon.logic.forecast import Forecaster
from rvmon.logic.formula import Factory
from rvmon.logic.lower import lower
from rvmon.logic.reduce import reduce
from rvmon.monitor.obligation_words import Words
from rvmon.testing.generate.formula import Shape, formula

SHAPE = Shape(mixed=False, past=False)
SIZES = ("locations", "clocks", "rows")
"""Of an automaton; its rows are its locations times their regions of age."""


def _size(automaton: Automaton) -> tuple[int, int, int]:
    return len(automaton.locations), automaton.clocks, len(automaton.time_values)


def nesting(part: Formula) -> int:
    """How many temporal operators are nested at most."""
    match part:
        case Unary(operand=operand, interval=interval):
            return (interval is not None) + nesting(operand)
        case Binary(left=left, right=right, interval=interval):
            return (interval is not None) + max(nesting(left), nesting(right))
        case _:
            return 0


def measure(options: argparse.Namespace) -> int:
    seconds: list[tuple[float, str]] = []
    automata: list[tuple[Automaton, Automaton]] = []
    forecasts: list[tuple[float, str]] = []
    refused: Counter[str] = Counter()
    for drawn in itertools.count():
        if len(seconds) == options.formulas:
            break
        rng = random.Random(f"{options.seed}/{drawn}")
        required = formula(rng, SHAPE, options.depth)
        if nesting(required) < options.depth:
            continue
        upon, whenever = (start, None) if len(seconds) % 2 else (None, p)
        shown = format_formula(required)
        began = time.process_time()
        try:
            made = _built(requirement(required, upon=upon, whenever=whenever))
        except DoesNotCloseError as error:
            refused[str(error)] += 1
            seconds.append((time.process_time() - began, shown))
            continue
        seconds.append((time.process_time() - began, shown))
        automata.append(made)
        forecasts += [(spent, shown) for spent in _forecast(made[1], rng)]
    count = len(seconds)
    print(f"{count} formulas, {options.depth} temporal operators nested, seed {options.seed}")
    share = 100 * len(automata) / count
    print(f"  automata {len(automata)} ({share:.0f} %), the rest by the network:")
    for reason, number in refused.most_common():
        print(f"    {number} {reason}")
    names = ("constructed", "reduced")
    for name, own in zip(names, zip(*automata, strict=True), strict=True):
        for what, values in zip(SIZES, zip(*map(_size, own), strict=True), strict=True):
            middle = statistics.median(values)
            print(f"  {name}: {what} median {middle:g}, largest {max(values)}, sum {sum(values)}")
    _print_seconds(seconds)
    print(f"  {len(forecasts)} forecasts, of what may be required at the end of a trace")
    _print_seconds(forecasts)
    return int(max(max(seconds), max(forecasts))[0] > options.most)


def _forecast(automaton: Automaton, rng: random.Random) -> Iterator[float]:
    """Seconds for the forecasts of some locations, each at ages about its bounds."""
    forecaster = Forecaster()
    waiting = automaton.locations[PASSED + 1 :]
    for location in rng.sample(waiting, min(len(waiting), 10)):
        ages = [rng.choice((0, *cuts)) for cuts in location.cuts]
        began = time.process_time()
        forecaster.of(location.residual, sorted(ages, reverse=True), 1)
        yield time.process_time() - began


def _built(required: Requirement) -> tuple[Automaton, Automaton]:
    """The automaton as it is constructed, and as people are told of it."""
    factory = Factory()
    obligation = lower(required, factory)
    whole = construct(factory.next(obligation.required), alphabet_of(obligation.required), Budget())
    told = reduce(whole, Words(obligation.origins, required.consequent).label)
    return whole, told


def _print_seconds(seconds: Sequence[tuple[float, str]]) -> None:
    ordered, count = sorted(seconds), len(seconds)
    shares = {f"p{n}": ordered[min(count * n // 100, count - 1)][0] for n in (50, 90, 99)}
    print("  CPU s:", ", ".join(f"{name} {value:.3f}" for name, value in shares.items()), end="")
    print(f", longest {ordered[-1][0]:.3f}: {ordered[-1][1]}")
