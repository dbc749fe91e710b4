"""Random requirements of so many propositions that diagrams, not tables, class their letters."""

from __future__ import annotations

import random

import rvmon
from rvmon.spec.checked.specification import CheckedSpec

_ATOMS = (
    *("p", "q", "r", "e", "f", "changed(x)", "known(x)", "updated(y)", "mode == red"),
    *("x > 0", "x > 1", "x <= 2", "y > 0", "y >= 2", "y < 3", "x == y", "g.k > 0", "g.k > 1"),
)

_HEADS = (
    "always ({})",
    "whenever p then {}",
    "upon e then {}",
    "upon start then {}",
    "upon g then {}\n  for each k in g.k",
    "upon p then {}\n  let v = x",
)


def random_letters(rng: random.Random) -> CheckedSpec:
    """A specification with such a requirement, of 17 or 18 propositions, in any model of time."""
    time = rng.choice(("held", "sampled", f"sampled every {rng.randint(1, 3)} ns"))
    window, joint = rng.choice((("F", " or "), ("G", " and ")))
    parts = rng.sample(_ATOMS, rng.randint(17, 18))
    formula = joint.join(f"{window}[0 ns, {n} ns] ({part})" for n, part in enumerate(parts))
    text = rng.choice(_HEADS).format(formula)
    return rvmon.loads(
        f"time {time}\nsignal p, q, r : bool\nsignal x : real\nsignal y : int\n"
        f"signal mode : {{red, green}}\nevent e, f\nevent g(k: int)\nrequirement R\n  {text}\n"
    ).checked
