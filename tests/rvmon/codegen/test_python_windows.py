"""Windows within windows as generated code follows them."""

import random

import pytest
from tests.tools.chains import random_chain

from rvmon.codegen.python_windows import windows_class
from rvmon.dataflow.chain import chain_of
from rvmon.dataflow.network import Network
from rvmon.formula.core import Constant
from rvmon.monitor import compile_spec


def random_plan(rng):
    """A plan that is a chain, its ticks between positions, and the chain."""
    while True:
        [compiled] = compile_spec(random_chain(rng)).requirements.values()
        chain = chain_of(compiled.network_plan, compiled.gap)
        if chain is not None:
            return compiled.network_plan, compiled.gap, chain


def random_letter(rng, plan, chain):
    """A letter as it is where nothing is unknown: what ends what is kept up does so at once."""
    ends = rng.random() < 0.05
    letter = []
    for place, core in plan.leaves:
        value = rng.random() < 0.6
        if isinstance(core, Constant):
            value = core.value
        elif chain.left is not None and place not in (chain.base, *base_of(plan, chain)):
            value = ends
        letter.append(value)
    return tuple(letter)


def base_of(plan, chain):
    """The leaves of what the innermost window is over."""
    return getattr(plan.nodes[chain.base], "operands", ())


@pytest.mark.parametrize("seed", range(60))
def test_they_know_what_a_network_knows(seed):
    """Of each position the value and the stamp, at any time, though much is forgotten."""
    rng = random.Random(seed)
    plan, gap, chain = random_plan(rng)
    network, step = Network(plan, gap), gap or 1
    t, windows, waiting, decided = -5 * step, None, [], 0

    def compare(limit):
        """At a stamp, whatever was known before."""
        network.grow(limit)
        found = 0
        for position in [*waiting]:
            value, at = windows.outcome(position)
            known = network.truth_at(len(plan.nodes) - 1, position)
            assert known == ((value, at) if at <= limit else None)
            if known is not None:
                waiting.remove(position)
                found += 1
        return found

    for _ in range(60):
        t += rng.choice((1, 1, 2, 3, 12)) * step
        letter = random_letter(rng, plan, chain)
        if windows is None:
            windows = windows_class(plan, chain, gap)(t // step, letter)
        else:
            decided += compare(2 * t)
            if rng.random() < 0.3:
                start = windows.forget(t // step)
                assert chain.left is not None or all(start <= position for position in waiting)
        windows.note(t // step, letter)
        network.note(t, letter)
        waiting.append(t // step)
        decided += compare(2 * t + 1)
    assert decided > 5
