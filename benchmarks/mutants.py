"""Changes of source that tests should see, drawn evenly over their kinds."""

from __future__ import annotations

import argparse
import itertools
import random
from collections.abc import Iterable

from rvmon.cdv.mutation.mutant import Mutant

KINDS = (
    *("comparison", "and/or", "dropped operand", "dropped not", "off by one", "operator"),
    *("constant", "swapped branches", "negated condition", "function", "dropped statement"),
)
"""The changes of Python code that are tried."""


def draw(found: Iterable[Mutant], options: argparse.Namespace) -> list[Mutant]:
    """A seeded sample, the kinds of change in turn; what is drawn depends on no other mutant."""
    kinds: dict[str, list[Mutant]] = {}
    for mutant in found:
        kinds.setdefault(mutant.kind, []).append(mutant)
    for members in kinds.values():
        members.sort(key=lambda mutant: random.Random(f"{options.seed} {mutant.change}").random())
    rounds = itertools.chain.from_iterable(itertools.zip_longest(*kinds.values()))
    return [*itertools.islice(filter(None, rounds), options.count)]
