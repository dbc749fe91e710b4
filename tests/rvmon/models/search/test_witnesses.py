"""A run comes with the exact window of each wait."""

from fractions import Fraction

import pytest

from rvmon.models.language.load import loads_network
from rvmon.models.runs import Run, RunStep, Window
from rvmon.models.runs.exact_times import InvalidRunError, Rules
from rvmon.models.search.budget import Policy
from rvmon.models.search.verify import verify

RELAY = """
clock x, y
automaton A {
  location a invariant x <= 5
  location b invariant x <= 7
  location c
  start a
  edge a -> b when x >= 2 do y = 0
  edge b -> c when y > 1 and x < 7
}
"""


def test_windows_are_exact():
    run = verify(loads_network(RELAY), "E<> A.c").run
    assert [step.window for step in run.steps] == [
        Window(2, 5, False, False),
        Window(1, 5, True, True),
    ]
    assert run.steps[0].delay == 2
    assert run.steps[1].delay in run.steps[1].window


@pytest.mark.parametrize("position", [0, 1])
def test_replay_rejects_a_delay_outside_its_window(position):
    network = loads_network(RELAY)
    run = verify(network, "E<> A.c").run
    steps = list(run.steps)
    broken = steps[position]
    wide = Window(0, None)
    steps[position] = RunStep(wide, Fraction(1, 2), broken.action, broken.position)
    with pytest.raises(InvalidRunError):
        Rules(network).replay(Run(run.start, tuple(steps)))


def test_each_policy_finds_its_run():
    """The shortest run takes long, the fastest is improbable, the likeliest has most steps."""
    network = loads_network("""
    clock x
    automaton A {
      location a  location b  location c  location d  location e
      start a
      edge a -> c when x >= 9 weight 0.1
      edge a -> b when x >= 1 weight 0.2
      edge b -> c when x >= 2
      edge a -> d when x >= 5 weight 0.7
      edge d -> e
      edge e -> c
    }
    """)
    runs = {policy: verify(network, "E<> A.c", policy=policy).run for policy in Policy}
    assert {policy: (len(run.steps), run.duration) for policy, run in runs.items()} == {
        Policy.SHORTEST: (1, 9),
        Policy.FASTEST: (2, 2),
        Policy.LIKELIEST: (3, 5),
    }


def test_the_duration_of_the_fastest_run_includes_the_wait_for_the_goal():
    network = loads_network("""
    clock x
    automaton A {
      location a
      location b
      start a
      edge a -> b when x >= 1 do x = 0
      edge a -> b when x >= 2
    }
    """)
    run = verify(network, "E<> A.b and x >= 5", policy=Policy.FASTEST).run
    assert run.duration == 5
