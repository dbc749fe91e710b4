"""Automata of random formulas: how many close, how large they get, how long they take."""

from __future__ import annotations

import itertools
import random
import statistics
import time
from collections import Counter

from tests.tools.build import p, requirement, start

from rvmon.language.checked.formula import Binary, Formula, Unary
from rvmon.language.checked.specification import Requirement
from rvmon.language.print import format_formula
from rvmon.logic.alphabet import alphabet_of
from rvmon.logic.automaton import Automaton
from rvmon.logic.construct import Budget, DoesNotCloseError, construct
from rvmon.logic.formula import Factory
from rvmon.logic.lower import lower
from rvmon.logic.reduce import reduce
from rvmon.monitor.obligation_words import Words
from rvmon.testing.generate.formula import formula
from rvmon.testing.generate.numbers import Shape

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


def automata(*, formulas: int = 600, depth: int = 3, seed: int = 1, most: float = 2.0) -> int:
    """Automata of random formulas."""
    seconds: list[tuple[float, str]] = []
    made: list[tuple[Automaton, Automaton]] = []
    refused: Counter[str] = Counter()
    for drawn in itertools.count():
        if len(seconds) == formulas:
            break
        required = formula(random.Random(f"{seed}/{drawn}"), SHAPE, depth)
        if nesting(required) < depth:
            continue
        upon, whenever = (start, None) if len(seconds) % 2 else (None, p)
        began = time.process_time()
        try:
            made.append(_built(requirement(required, upon=upon, whenever=whenever)))
        except DoesNotCloseError as error:
            refused[str(error)] += 1
        seconds.append((time.process_time() - began, format_formula(required)))
    print(f"{formulas} formulas, {depth} temporal operators nested, seed {seed}")
    share = 100 * len(made) / formulas
    print(f"  automata {len(made)} ({share:.0f} %), the rest by the network:")
    for reason, number in refused.most_common():
        print(f"    {number} {reason}")
    for name, own in zip(("constructed", "reduced"), zip(*made, strict=True), strict=True):
        for what, values in zip(SIZES, zip(*map(_size, own), strict=True), strict=True):
            middle = statistics.median(values)
            print(f"  {name}: {what} median {middle:g}, largest {max(values)}, sum {sum(values)}")
    ordered = sorted(seconds)
    shares = (f"p{n} {ordered[formulas * n // 100][0]:.3f}" for n in (50, 90, 99))
    print(f"  CPU s: {', '.join(shares)}, longest {ordered[-1][0]:.3f}: {ordered[-1][1]}")
    return int(ordered[-1][0] > most)


def _built(required: Requirement) -> tuple[Automaton, Automaton]:
    """The automaton as it is constructed, and as people are told of it."""
    factory = Factory()
    obligation = lower(required, factory)
    whole = construct(factory.next(obligation.required), alphabet_of(obligation.required), Budget())
    told = reduce(whole, Words(obligation.origins, required.consequent).label)
    return whole, told
