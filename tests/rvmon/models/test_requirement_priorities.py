"""Requirements on networks in which steps have priorities."""

import pytest

import rvmon
from rvmon.models.language.load import loads_network
from rvmon.models.requirement_check import observe
from rvmon.models.runs.exact_times import InvalidRunError, Rules

MODEL = """
unit 1 s
clock x
broadcast chan high, low
int[0,1] v
automaton A {{ location a {stay} location b start a
  edge a -> b when x >= 2 and v == 0 on low! as slow }}
automaton B {{ location a {stay} location b start a
  edge a -> b when x >= 2 on high! do v = 1 as quick }}
{ranks}
"""
FORCED = "invariant x <= 2"

SPEC = """
spec s
time held
event slow, quick
requirement R
  {}
"""


def answer(requirement, ranks, stay=FORCED):
    """The observation of one requirement; its runs are runs of the network, priorities and all."""
    network = loads_network(MODEL.format(stay=stay, ranks=ranks))
    (one,) = observe(network, rvmon.loads(SPEC.format(requirement)).checked)
    for run in (one.triggered, one.passing, one.failing):
        if run is not None:
            Rules(one.network).replay(run)
    return one


RANKED = ["chan priority low, default < high", "chan priority low < default, high",
          "chan priority low < default < high", "chan priority low < high < default",
          "system A < B"]  # fmt: skip
EQUAL = ["", "chan priority default < low, high", "system A, B"]
REVERSED = ["chan priority high < low < default", "system B < A"]


@pytest.mark.slow
@pytest.mark.parametrize("ranks", RANKED)
def test_a_requirement_may_hold_by_priority_alone(ranks):
    assert answer("upon start then for 3 s not slow", ranks).holds is True
    assert answer("upon start then within 2 s quick", ranks).holds is True


@pytest.mark.parametrize("ranks", [*EQUAL, *REVERSED])
def test_without_it_the_requirement_fails(ranks):
    one = answer("upon start then for 3 s not slow", ranks)
    assert one.holds is False
    network = loads_network(MODEL.format(stay=FORCED, ranks=RANKED[0]))
    with pytest.raises(InvalidRunError):
        Rules(network).replay(one.failing)


@pytest.mark.slow
@pytest.mark.parametrize("ranks", [*EQUAL, *RANKED, *REVERSED])
def test_no_priority_makes_time_wait(ranks):
    one = answer("upon start then within 2 s quick", ranks, stay="")
    assert one.holds is False
    assert one.failing.duration >= 2
    assert answer("upon start then within 2 s (quick or slow)", ranks, stay="").holds is False


@pytest.mark.slow
@pytest.mark.parametrize("ranks", [*EQUAL, *RANKED, *REVERSED])
def test_no_deadline_comes_before_a_step_at_its_instant(ranks):
    assert answer("upon start then within 2 s (quick or slow)", ranks).holds is True
    late = answer("upon start then within 1.5 s (quick or slow)", ranks)
    assert late.holds is False
    both = answer("upon quick then for 1 s not slow", ranks)
    assert both.holds is True
