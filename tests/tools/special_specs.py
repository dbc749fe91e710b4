"""Random requirements that the general generator seldom makes: nested windows, many letters."""

from __future__ import annotations

import random

import rvmon
from rvmon.language.checked.specification import CheckedSpec

_SIGNALS = """signal p, q, r : bool
signal x : real
signal y : int
signal mode : {red, green}
event e, f
event g(k: int)
requirement R
"""

_HEADS = (
    "always ({})",
    "whenever p then {}",
    "upon e then {}",
    "upon start then {}",
    "upon g then {}\n  for each k in g.k",
    "upon p then {}\n  let v = x",
)
_CHAIN_HEADS = (
    *_HEADS,
    "always (p -> {})",
    "whenever p and r then {}",
    "whenever p or {} then {}",
    "upon p then {}",
    "upon p then r R {}",
)

_TAILS = ("", "  at end: strict\n", "  at end: strong\n")


def random_chain(rng: random.Random, *, untils: bool = False) -> CheckedSpec:
    """A specification with such a requirement, in any model of time."""
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
    head = rng.choice(_CHAIN_HEADS)
    text = head.format(*(("r", formula) if head.count("{") > 1 else (formula,)))
    return rvmon.loads(f"time {time}\n{_SIGNALS}  {text}\n{rng.choice(_TAILS)}").checked


_ATOMS = (
    *("p", "q", "r", "e", "f", "changed(x)", "known(x)", "updated(y)", "mode == red"),
    *("x > 0", "x > 1", "x <= 2", "y > 0", "y >= 2", "y < 3", "x == y", "g.k > 0", "g.k > 1"),
)


def random_letters(rng: random.Random) -> CheckedSpec:
    """A specification with such a requirement, of 17 or 18 propositions, in any model of time."""
    time = rng.choice(("held", "sampled", f"sampled every {rng.randint(1, 3)} ns"))
    window, joint = rng.choice((("F", " or "), ("G", " and ")))
    parts = rng.sample(_ATOMS, rng.randint(17, 18))
    formula = joint.join(f"{window}[0 ns, {n} ns] ({part})" for n, part in enumerate(parts))
    text = rng.choice(_HEADS).format(formula)
    return rvmon.loads(f"time {time}\n{_SIGNALS}  {text}\n").checked
