"""Automata of random formulas: how many close, how large they get, how long they take.

Formulas are drawn until so many temporal operators are nested in each as was asked for; every other
is required from the start, the others `whenever p`. CPU times are of construction and reduction
together; then of forecasts, ten at most for each automaton. Exits 1 if one takes longer
than the budget of `--most` seconds.
"""

from __future__ import annotations

import argparse
import random
import statistics
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tests.tools.build import p, requirement, start

from rvmon.logic.automaton import PASSED, Automaton
from rvmon.logic.construct import Budget, DoesNotCloseError, construct
from rvmon.logic.forecast import Forecaster
from rvmon.logic.formula import Factory
from rvmon.logic.letters import alphabet_of
from rvmon.logic.lower import lower
from rvmon.logic.reduce import reduce
from rvmon.monitor.obligation_words import Words
from rvmon.spec.checked.formula import Binary, Formula, Unary
from rvmon.spec.print import format_formula
from rvmon.testing.generate.formula import Shape, formula

SHAPE = Shape(mixed=False, past=False)


@dataclass(frozen=True, slots=True)
class Size:
    """How large an automaton is."""

    locations: int
    clocks: int
    rows: int

    @classmethod
    def of(cls, automaton: Automaton) -> Size:
        """Of one automaton; its rows are its locations times their regions of age."""
        return cls(len(automaton.locations), automaton.clocks, len(automaton.time_values))


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
    """Draw, build, measure, print."""
    seconds: list[tuple[float, str]] = []
    sizes: list[tuple[Size, Size]] = []
    refused: Counter[str] = Counter()
    forecasts: list[tuple[float, str]] = []
    drawn = 0
    while len(seconds) < options.formulas:
        rng = random.Random(f"{options.seed}/{drawn}")
        drawn += 1
        required = formula(rng, SHAPE, options.depth)
        if nesting(required) < options.depth:
            continue
        mode = {"upon": start} if len(seconds) % 2 else {"whenever": p}
        began = time.process_time()
        found: Automaton | None = None
        try:
            found, own = _built(required, mode)
            sizes.append(own)
        except DoesNotCloseError as error:
            refused[str(error)] += 1
        seconds.append((time.process_time() - began, format_formula(required)))
        if found is not None:
            forecasts += [(spent, format_formula(required)) for spent in _forecast(found, rng)]
    _print(options, sizes, refused, seconds)
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


def _built(required: Formula, mode: dict[str, Formula]) -> tuple[Automaton, tuple[Size, Size]]:
    """The automaton, and its size as made, and as people are told of it."""
    factory = Factory()
    obligation = lower(
        requirement(required, upon=mode.get("upon"), whenever=mode.get("whenever")), factory
    )
    whole = construct(factory.next(obligation.required), alphabet_of(obligation.required), Budget())
    told = reduce(whole, Words(obligation.origins).label)
    return told, (Size.of(whole), Size.of(told))


def _print(
    options: argparse.Namespace,
    sizes: Sequence[tuple[Size, Size]],
    refused: Counter[str],
    seconds: Sequence[tuple[float, str]],
) -> None:
    count = len(seconds)
    print(f"{count} formulas, {options.depth} temporal operators nested, seed {options.seed}")
    print(f"  automata {len(sizes)} ({100 * len(sizes) / count:.0f} %), the rest by the network:")
    for reason, number in refused.most_common():
        print(f"    {number} {reason}")
    for place, name in enumerate(("constructed", "reduced")):
        own = [size[place] for size in sizes]
        for what in ("locations", "clocks", "rows"):
            values = [getattr(size, what) for size in own]
            middle = statistics.median(values)
            print(f"  {name}: {what} median {middle:g}, largest {max(values)}, sum {sum(values)}")
    _print_seconds(seconds)


def _print_seconds(seconds: Sequence[tuple[float, str]]) -> None:
    ordered, count = sorted(seconds), len(seconds)
    shown = {
        f"p{share}": ordered[min(count * share // 100, count - 1)][0] for share in (50, 90, 99)
    }
    print("  CPU s:", ", ".join(f"{name} {value:.3f}" for name, value in shown.items()), end="")
    print(f", longest {ordered[-1][0]:.3f}: {ordered[-1][1]}")
