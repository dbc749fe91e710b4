"""What judges, against the oracle: tables, generated Python, arrays, the core.

    python -m benchmarks.all_forms --pairs 10000 --workers 2

Each form judges so many pairs of a random specification and a random trace; what it does not judge
counts apart. Columns in memory (`batch`, and `core, columns`) have whole rows, in blocks of random
length. Prints a line per form and every disagreement, and exits with 1 if there is one.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from functools import partial
from itertools import count

from tests.tools.differential import campaign
from tests.tools.forms import Maker

from benchmarks import columns
from rvmon.execute.interrupt import interrupted_by_sigterm
from rvmon.execute.parallel import execute
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

PART = 10
"""Specifications that a worker takes at a time."""

FIGURES = ("pairs", "refused", "disagreements")

Judge = Callable[[list[str]], "Counter[str]"]


def stepped(engine: str, each: int, seeds: list[str]) -> Counter[str]:
    """Judge the cases of some seeds sample by sample; runs in a worker."""
    tally = campaign(Maker(engine), seeds, Profile(), TraceProfile(), each=each)
    for text in tally.disagreements:
        print(text, flush=True)
    return Counter(
        pairs=tally.pairs,
        refused=tally.refused,
        disagreements=len(tally.disagreements),
    )


def batched(engine: str, each: int, seeds: list[str]) -> Counter[str]:
    """Judge the cases of some seeds as columns; runs in a worker."""
    options = columns.parse(["--engine", engine, "--each", str(each)])
    found: Counter[str] = Counter()
    for seed in seeds:
        columns.judge_seed(seed, options, found)
    return found


FORMS: dict[str, Callable[[int], Judge]] = {
    "table": lambda each: partial(stepped, "automaton", each),
    "generated Python": lambda each: partial(stepped, "python", each),
    "batch": lambda each: partial(batched, "auto", each),
    "core, stepped": lambda each: partial(stepped, "c", each),
    "core, rows": lambda each: partial(stepped, "c rows", each),
    "core, columns": lambda each: partial(batched, "c", each),
}


def judge_of(form: str, each: int) -> Judge:
    """What judges the cases of some seeds; runs in a worker."""
    return FORMS[form](each)


def parts(seed: int) -> Iterator[list[str]]:
    """Seeds for the workers, without end."""
    for number in count():
        yield [f"{seed}/{number}/{index}" for index in range(PART)]


def judge_form(form: str, options: argparse.Namespace) -> Counter[str]:
    """Have a form judge as many pairs as are asked for."""
    total: Counter[str] = Counter()
    begin = partial(judge_of, form, options.each)
    with closing(execute(parts(options.seed), begin, jobs=options.workers, what="part")) as judged:
        for found in judged:
            total += found
            if total["pairs"] + total["disagreements"] >= options.pairs:
                break
    return total


def main(argv: Sequence[str]) -> int:
    """Judge with all forms and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--pairs", type=int, default=10_000, help="that each form judges")
    parser.add_argument("--each", type=int, default=10, help="traces per specification")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--form", choices=FORMS, nargs="+", default=FORMS, metavar="FORM")
    options = parser.parse_args(argv)
    wrong = 0
    with interrupted_by_sigterm():
        for form in options.form:
            began = time.perf_counter()
            found = judge_form(form, options)
            figures = ", ".join(f"{name} {found[name]}" for name in FIGURES)
            print(f"{form:16} {figures}, {time.perf_counter() - began:.0f} s", flush=True)
            wrong += found["disagreements"]
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
