"""Random requirements of windows within windows, which the core follows as chains."""

from __future__ import annotations

import random

import rvmon
from rvmon.spec.checked.specification import CheckedSpec

_HEADS = (
    "always ({})",
    "always (p -> {})",
    "whenever p and r then {}",
    "whenever p or {} then {}",
    "upon p then {}",
    "upon e then {}",
    "upon p then r R {}",
    "upon start then {}",
    "upon g then {}\n  for each k in g.k",
    "upon p then {}\n  let v = x",
)

_TAILS = (
    "",
    "  at end: strict\n",
    "  at end: strong\n",
)


def random_chain(rng: random.Random, *, untils: bool = False) -> CheckedSpec:
    """A specification with such a requirement, in any model of time.

    Args:
        rng: draws it.
        untils: whether `until` and its dual, in bounds, stand in the place of some windows.
    """
    time = rng.choice(("held", "sampled", f"sampled every {rng.randint(1, 3)} ns"))
    formula = rng.choice(("q", "not q", "(q and r)", "(q or r)", "x > 1"))
    for _ in range(rng.choice((1, 2, 2, 3, 3, 4))):
        low = rng.choice((0, 0, 1, 3)) if time != "sampled" or rng.random() < 0.2 else 0
        high = low + rng.choice((0, 1, 2, 5, 9))
        bounds = f"[{low} ns, {high} ns]"
        if untils and rng.random() < 0.6:
            left = rng.choice(("q", "not r", "p", f"F[0 ns, {rng.randint(0, 3)} ns] r"))
            formula = f"(({left}) {rng.choice('UR')}{bounds} ({formula}))"
        else:
            formula = f"{rng.choice('FG')}{bounds} {formula}"
    head = rng.choice(_HEADS)
    text = head.format(*(("r", formula) if head.count("{") > 1 else (formula,)))
    return rvmon.loads(
        f"time {time}\nsignal p, q, r : bool\nsignal x : real\nevent e\nevent g(k: int)\n"
        f"requirement R\n  {text}\n{rng.choice(_TAILS)}"
    ).checked
