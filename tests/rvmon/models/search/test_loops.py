"""Time passes on a loop if and only if more rounds can take longer."""

from math import inf
from random import Random

import pytest

from rvmon.models.runs import bound_of
from rvmon.models.runs.timing import TimedStep, timing_of
from rvmon.models.search.native_search import surely_passes, time_passes

DIM = 3
ANYWHERE = [0.0 if x == y or y == 0 else inf for x in range(DIM) for y in range(DIM)]


def longest(loop, rounds):
    """The longest duration of so many rounds, in whole units; `None` if they are impossible."""
    timing = timing_of(loop * rounds, ANYWHERE)
    if timing is None:
        return None
    longest = float(timing.relation((0, len(loop) * rounds))[0, 1])
    return longest if longest == inf else -(-longest // timing.scale)


def random_loop(random):
    """One to four steps with bounds and resets of two clocks."""

    def atoms():
        found = []
        for _ in range(random.choice((0, 0, 1, 1, 2))):
            clock, number = random.randint(1, 2), random.randint(0, 3)
            strict = random.random() < 0.4
            if random.random() < 0.6:
                found.append((0, clock, bound_of(number, strict)))
            else:
                found.append((clock, 0, bound_of(-number, strict)))
        return tuple(found)

    def resets():
        clocks = random.choice(((), (), (1,), (2,), (1, 2)))
        return tuple((clock, float(random.choice((0, 0, 1)))) for clock in clocks)

    return [
        TimedStep(random.random() < 0.8, atoms(), resets(), atoms())
        for _ in range(random.randint(1, 4))
    ]


@pytest.mark.slow
def test_the_answer_agrees_with_unrolled_rounds():
    random, seen = Random(1), []
    for _ in range(700):
        loop = random_loop(random)
        fewer, more = longest(loop, 4), longest(loop, 16)
        if more is None or fewer == inf:
            continue
        passes = time_passes(loop, ANYWHERE, DIM)
        assert passes == (fewer < more), loop
        sure = surely_passes(loop)
        assert sure in (None, passes), loop
        seen.append((sure, passes))
    assert {(True, True), (False, False), (None, True), (None, False)} <= set(seen)


@pytest.mark.slow
def test_time_passes_on_a_loop_of_hundreds_of_steps():
    step = TimedStep(True, ((0, 1, 5.0),), (), ())
    last = TimedStep(True, ((0, 1, 5.0),), ((1, 0.0), (2, 0.0)), ())
    assert time_passes([*[step] * 300, last], ANYWHERE, DIM)
