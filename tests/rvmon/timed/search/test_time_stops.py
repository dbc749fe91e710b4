"""Zeno loops, time-locks and deadlocks are told apart and said to be what they are."""

import pytest

from rvmon.errors import ModelError
from rvmon.timed.language.load import loads_network
from rvmon.timed.runs.run import Ending
from rvmon.timed.search.verify import verify

LOOP = """
clock x
automaton A {{
  location a invariant x <= 5
  location b
  start a
  edge a -> a {first}
  edge a -> b when x >= 5
}}
"""


def ending(text, query):
    """How the run ends that decides a query."""
    outcome = verify(loads_network(text), query)
    return outcome.holds, outcome.run.ending if outcome.run else None


def test_a_zeno_loop_is_called_one():
    """A loop in which time cannot pass on is no plain counterexample."""
    outcome = verify(loads_network(LOOP.format(first="")), "A<> A.b")
    assert outcome.holds is False
    assert outcome.run.ending is Ending.ZENO_LOOP
    assert "Zeno" in outcome.remark


def test_a_loop_with_time_is_a_plain_one():
    """If the loop resets the clock, time passes and the run is a real one."""
    assert ending(LOOP.format(first="do x = 0"), "A<> A.b") == (False, Ending.LOOP)


def test_a_proper_run_is_preferred():
    """Where a Zeno loop and a real loop both avoid the goal, the real one is shown."""
    text = LOOP.format(first="edge a -> a when x >= 1 do x = 0")
    assert ending(text, "A<> A.b") == (False, Ending.LOOP)


def test_a_loop_that_converges_is_zeno():
    """Delays that must shrink from round to round add up to less than a bound."""
    text = """
    clock x, total
    automaton A {
      location a invariant total <= 3
      location b
      start a
      edge a -> a when x > 0 do x = 0
      edge a -> b when total == 3
    }
    """
    assert ending(text, "A<> A.b") == (False, Ending.ZENO_LOOP)


def test_a_time_lock_is_called_one():
    """A state that must be left but cannot be is a time-lock."""
    text = """
    clock x
    automaton A {
      location a
      location b invariant x <= 3
      location c
      start a
      edge a -> b when x <= 4
      edge b -> c when x <= 1
    }
    """
    assert ending(text, "E<> deadlock and A.b") == (True, Ending.TIME_LOCK)
    assert ending(text, "A.b --> A.c") == (False, Ending.TIME_LOCK)


def test_a_deadlock_with_time_is_called_one():
    """A state that nothing leaves while time goes on is a deadlock; idling there is a run."""
    text = "automaton A { location a location b start a edge a -> b }"
    assert ending(text, "A[] not deadlock") == (False, Ending.DEADLOCK)
    assert ending(text, "A[] (deadlock imply A.b)") == (True, None)
    assert ending(text, "A<> A.b") == (False, Ending.IDLE)


def test_a_deadlock_in_part_of_a_zone_is_found():
    """Only some clock values are stuck; simulation would overlook or invent it."""
    text = """
    clock x, y
    automaton A {
      location a invariant y <= 3
      location b invariant y <= 3
      start a
      edge a -> b when x >= 1 do x = 0
      edge b -> b when x == 2 do x = 0, y = 0
    }
    """
    network = loads_network(text)
    assert verify(network, "E<> A.b and y <= 1 and not deadlock").holds
    outcome = verify(network, "E<> A.b and deadlock")
    assert outcome.holds
    assert outcome.run.steps[0].window.low == 1


@pytest.mark.parametrize(
    "text",
    [
        "clock x automaton A { location a invariant x < 0 start a }",
        "int[0,1] v automaton A { location a invariant v == 1 start a }",
    ],
)
def test_a_model_that_cannot_start_is_refused(text):
    """A model without any run is a finding with place and fix, not an answer."""
    with pytest.raises(ModelError) as caught:
        verify(loads_network(text), "E<> A.a")
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "TA014"
    assert diagnostic.spans
    assert diagnostic.help


@pytest.mark.parametrize(
    "text",
    [
        "clock x automaton A { location a invariant x < 3 start a edge a -> a when x > 3 }",
        "automaton A { urgent location a start a }",
    ],
)
def test_a_time_lock_at_the_start_is_an_answer(text):
    """Time stops where the run begins: there is that one run, and it is told."""
    network = loads_network(text)
    assert verify(network, "E<> deadlock").run.ending is Ending.TIME_LOCK
    assert not verify(network, "A[] not deadlock").holds
    assert verify(network, "E[] A.a").holds
