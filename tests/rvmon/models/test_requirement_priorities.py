"""Requirements on networks in which steps have priorities."""

import pytest

import rvmon
from rvmon.models.language.load import loads_network
from rvmon.models.requirement_check import observe
from rvmon.models.runs.exact_times import InvalidRunError, Rules

pytestmark = pytest.mark.slow

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
RANKED = ["chan priority low, default < high", "chan priority low < default, high",
          "chan priority low < default < high", "chan priority low < high < default",
          "system A < B"]  # fmt: skip
OTHERS = ["", "chan priority default < low, high", "system A, B",
          "chan priority high < low < default", "system B < A"]  # fmt: skip


def answer(requirement, ranks, stay=FORCED):
    """The observation of one requirement, whose runs obey all rules including priorities."""
    network = loads_network(MODEL.format(stay=stay, ranks=ranks))
    text = f"spec s\ntime held\nevent slow, quick\nrequirement R\n  {requirement}\n"
    (one,) = observe(network, rvmon.loads(text).checked)
    for run in (one.triggered, one.passing, one.failing):
        if run is not None:
            Rules(one.network).replay(run)
    return one


@pytest.mark.parametrize("ranks", [*RANKED, *OTHERS])
def test_a_requirement_may_hold_by_priority_alone(ranks):
    """A priority never delays a step, and a step at the deadline is still in time."""
    one = answer("upon start then for 3 s not slow", ranks)
    assert one.holds is (ranks in RANKED)
    if ranks in OTHERS:
        network = loads_network(MODEL.format(stay=FORCED, ranks=RANKED[0]))
        with pytest.raises(InvalidRunError):
            Rules(network).replay(one.failing)
    for requirement, stay, holds in (
        ("upon start then within 2 s quick", FORCED, True),
        ("upon start then within 2 s (quick or slow)", FORCED, True),
        ("upon start then within 1.5 s (quick or slow)", FORCED, False),
        ("upon quick then for 1 s not slow", FORCED, True),
        ("upon start then within 2 s quick", "", False),
        ("upon start then within 2 s (quick or slow)", "", False),
    ):
        assert answer(requirement, ranks, stay).holds is holds, (requirement, stay)
    assert answer("upon start then within 2 s quick", ranks, "").failing.duration >= 2
