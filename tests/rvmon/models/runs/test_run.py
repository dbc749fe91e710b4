"""Timing computed instant by instant equals the closure of all constraints."""

from math import inf
from random import Random

import numpy as np
import pytest

from rvmon.models.language.load import loads_network
from rvmon.models.runs import Timing, close
from rvmon.models.search.verify import verify


def random_timing(random):
    """Up to eight instants and two earlier ones, each constrained only by what precedes it."""
    count, others = random.randint(1, 8), random.randint(0, 2)
    early = [0, *range(count + 1, count + 1 + others)]

    def some(known, most):
        pairs = (
            [random.sample(known, 2) for _ in range(random.randint(0, most))] if known[1:] else []
        )
        return [(p, q, float(random.randint(-4, 9))) for p, q in pairs]

    constraints = [some(early, 1)]
    constraints += [
        [(now, now - 1, 0.0), *some([*early, *range(1, now + 1)], 2)] for now in range(1, count + 1)
    ]
    bounds = np.full((count + 1 + others,) * 2, inf)
    np.fill_diagonal(bounds, 0)
    for first, second, bound in (one for own in constraints for one in own):
        bounds[first, second] = min(bounds[first, second], bound)
    close(bounds)
    return Timing(constraints, others, 1), bounds, count, early


@pytest.mark.law
def test_incremental_timing_agrees_with_the_closure_of_all_constraints():
    random, possible = Random(3), 0
    for _ in range(600):
        timing, bounds, count, early = random_timing(random)
        assert timing.is_possible == bool((bounds.diagonal() >= 0).all())
        if not timing.is_possible:
            continue
        possible += 1
        assert timing.waits == [
            (-bounds[now, now - 1], bounds[now - 1, now], -bounds[now, 0])
            for now in range(1, count + 1)
        ]
        ends = [*early, count, random.randint(1, count)]
        assert (timing.relation(ends) == bounds[ends][:, ends]).all()
    assert 100 < possible < 500


@pytest.mark.slow
def test_a_run_of_a_thousand_steps_has_its_windows():
    network = loads_network("""
    clock x, y
    int[0,1200] n
    automaton A {
      location a invariant x <= 2
      start a
      edge a -> a when x >= 1 and n < 1200 do x = 0, n += 1
    }
    """)
    run = verify(network, "E<> n == 1200 and y > 1600").run
    moves = [step for step in run.steps if step.action is not None]
    assert len(moves) == 1200
    assert {(step.window.low, step.window.high) for step in moves} == {(1, 2)}
    assert 1600 < run.duration < 1601
    assert inf not in [first for _, _, first in run.timing.waits]
