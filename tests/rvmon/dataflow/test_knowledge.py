"""What a network knows of random letters: it sleeps through nothing, and misses nothing."""

import random

import pytest

import rvmon
from rvmon.dataflow import knowledge
from rvmon.dataflow.network import Network
from rvmon.formula.core import Constant
from rvmon.monitor import compile_spec


@pytest.mark.parametrize("seed", range(40))
def test_what_is_forgotten_is_not_missed(seed, monkeypatch):
    """Positions that are far apart, and an `until` in a window, which is asked for in between."""
    monkeypatch.setattr(knowledge, "_SELDOM", 1 + seed % 6)
    rng = random.Random(f"whole {seed}")
    low = rng.choice((0, 1, 3))
    sweep = f"({rng.choice('pq')} {rng.choice('UR')}[0 ns, {rng.randint(1, 4)} ns] not q)"
    formula = f"{rng.choice('FG')}[{low} ns, {low + rng.choice((2, 5, 9))} ns] {sweep}"
    head = rng.choice(("whenever p or r then {}", "always {}", "always (p -> {})"))
    text = f"time sampled\nsignal p, q, r : bool\nrequirement R\n  {head.format(formula)}\n"
    [compiled] = compile_spec(rvmon.loads(text).checked).requirements.values()
    plan, waiting, t, known = compiled.network_plan, [0], 0, 0
    whole, network = Network(plan, None), Network(plan, None)
    letter = random_letter(rng, plan)
    for _ in range(60):
        letter = random_letter(rng, plan) if rng.random() < 0.5 else letter
        last, t = t, t + rng.randint(1, 4)
        whole.note(last, letter)
        network.note(last, letter)
        for limit in (2 * last + 1, 2 * t) if rng.random() < 0.7 else ():
            whole.grow(limit)
            network.grow(limit, waiting[0])
            found = [one.truth(waiting[0]) and one.truth(waiting[0])[0] for one in (whole, network)]
            assert found[0] is found[1]
            if found[0] is not None:
                known, waiting = known + 1, [t]
    assert known or head.startswith("whenever")


def random_letter(rng, plan):
    """A letter, in which constants are what they are."""
    return tuple(
        core.value if isinstance(core, Constant) else rng.random() < 0.6 for _, core in plan.leaves
    )
