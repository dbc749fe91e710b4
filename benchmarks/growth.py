"""How cost grows: with open attempts, on streams that are hard, with tests, with operators.

    python -m benchmarks.growth cliffs [--rows 20000]
    python -m benchmarks.growth coverage [--tests 10000] [--items 1000] [--share 0.2]
    python -m benchmarks.growth automata --formulas 600 --depth 3

`cliffs` has streams beside their quiet neighbours. `coverage` records tests that hit a random share
of the items, with random counts and instants (real ones repeat, and take less room), and looks at
the database, each time in a process: seconds of the clock and of CPU, largest resident memory, exit
code, and the last line that was said; none may take more than 6 GiB. `automata` draws formulas with
so many temporal operators nested, every other required from the start, the others `whenever p`: how
many close, how large they get before and after they are reduced, how long that takes; it fails if
one takes more than `--most` seconds of CPU. Numbers of requirements and of recordings are those of
`benchmarks.online --only many` and `benchmarks.recordings`.
"""

from __future__ import annotations

import itertools
import random
import statistics
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from benchmarks.process import measured
from benchmarks.program import program
from benchmarks.timing.cliffs import cliffs
from tests.tools.build import p, requirement, start

from rvmon.coverage import Hit, Hits, Item, Subject, TestRecord, group_of, model_of
from rvmon.coverage.database import Database
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

RVMON = (sys.executable, "-m", "rvmon")
MOST_MEMORY = 6 << 30
HEAD = f"{'':44}{'s':>8}{'CPU s':>8}{'MiB':>8}{'exit':>6}"
"""Of the table of processes."""

GROUPS = 10
DIFFERENT = 100
"""Hits that are drawn ahead, so that drawing them is not measured; tests take them in turn."""


def _told(title: str, command: Sequence[str], limit: float) -> None:
    """Run a process and print a row of the table."""
    cost = measured(command, limit, memory=MOST_MEMORY)
    figures = f"{cost.seconds:8.2f}{cost.cpu:8.2f}{cost.mebibytes:8.0f}{cost.code:6}"
    print(f"{title:44}{figures}  {cost.said[:60]}", flush=True)


def coverage(
    *, tests: int = 10_000, items: int = 1_000, share: float = 0.2, limit: float = 600.0
) -> None:
    """A database of coverage: record, then look at it and merge it."""
    print(HEAD)
    rng = random.Random(1)
    each = [Item(f"item {item}") for item in range(items // GROUPS)]
    groups = [group_of(f"group {n}", Subject.COVERPOINT, each) for n in range(GROUPS)]
    names = [(group.name, item) for group in groups for item in group.items]
    drawn = [_hits(rng, names, share) for _ in range(DIFFERENT)]
    with tempfile.TemporaryDirectory() as folder:
        path, page, other = (Path(folder, name) for name in ("a.cov", "a.html", "b.cov"))
        began = time.process_time()
        with Database.open(path) as database:
            database.declare(model_of(groups))
            for number in range(tests):
                test = TestRecord(f"test {number}", "campaign", seed=number, number=number)
                database.record(test, drawn[number % DIFFERENT])
        spent = 1000 * (time.process_time() - began) / tests
        print(f"record: {spent:.2f} ms a test; {path.stat().st_size / 1e6:.1f} MB")
        for words in (
            [],
            ["--tests"],
            ["--format", "json"],
            ["--report", str(page)],
            ["--merge", str(other)],
        ):
            _told(" ".join(["cover", *words[:1]]), [*RVMON, "cover", str(path), *words], limit)
        print(f"page: {page.stat().st_size / 1e6:.1f} MB")


def _hits(rng: random.Random, names: list[tuple[str, str]], share: float) -> Hits:
    hits: dict[str, dict[str, Hit]] = {}
    for group, item in rng.sample(names, round(len(names) * share)):
        hits.setdefault(group, {})[item] = Hit(rng.randint(1, 50), rng.randrange(60_000_000_000))
    return hits


SHAPE = Shape(mixed=False, past=False)
SIZES = ("locations", "clocks", "rows")
"""Of an automaton; its rows are its locations times their regions of age."""


def automata(*, formulas: int = 600, depth: int = 3, seed: int = 1, most: float = 2.0) -> int:
    """Automata of random formulas."""
    seconds: list[tuple[float, str]] = []
    made: list[tuple[Automaton, Automaton]] = []
    refused: Counter[str] = Counter()
    for drawn in itertools.count():
        if len(seconds) == formulas:
            break
        required = formula(random.Random(f"{seed}/{drawn}"), SHAPE, depth)
        if _nesting(required) < depth:
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


def _size(automaton: Automaton) -> tuple[int, int, int]:
    return len(automaton.locations), automaton.clocks, len(automaton.time_values)


def _nesting(part: Formula) -> int:
    """How many temporal operators are nested at most."""
    match part:
        case Unary(operand=operand, interval=interval):
            return (interval is not None) + _nesting(operand)
        case Binary(left=left, right=right, interval=interval):
            return (interval is not None) + max(_nesting(left), _nesting(right))
        case _:
            return 0


def _built(required: Requirement) -> tuple[Automaton, Automaton]:
    """The automaton as it is constructed, and as people are told of it."""
    factory = Factory()
    obligation = lower(required, factory)
    whole = construct(factory.next(obligation.required), alphabet_of(obligation.required), Budget())
    told = reduce(whole, Words(obligation.origins, required.consequent).label)
    return whole, told


if __name__ == "__main__":
    sys.exit(program(__doc__, cliffs, coverage, automata))
