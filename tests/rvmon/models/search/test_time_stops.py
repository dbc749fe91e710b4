"""Zeno loops, time-locks and deadlocks are told apart."""

import pytest
from tests.tools.each import each
from tests.tools.findings import findings_of

from rvmon.errors import ModelError
from rvmon.models.language.load import loads_network
from rvmon.models.runs import Ending
from rvmon.models.search.suite import Criterion, build_suite
from rvmon.models.search.verify import verify

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
CONVERGING = """
clock x, total
automaton A {
  location a invariant total <= 3
  location b
  start a
  edge a -> a when x > 0 do x = 0
  edge a -> b when total == 3
}
"""
LOCKED = """
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
IDLE = "automaton A { location a location b start a edge a -> b }"

ENDINGS = {
    "a loop on which time cannot diverge is a Zeno loop": (
        *(LOOP.format(first=""), "A<> A.b", Ending.ZENO_LOOP),
    ),
    "if the loop resets the clock, time diverges": (
        *(LOOP.format(first="do x = 0"), "A<> A.b", Ending.LOOP),
    ),
    "if a Zeno loop and a real loop both avoid the goal, the real one is shown": (
        *(LOOP.format(first="edge a -> a when x >= 1 do x = 0"), "A<> A.b", Ending.LOOP),
    ),
    "delays that must shrink from round to round have a bounded sum": (
        *(CONVERGING, "A<> A.b", Ending.ZENO_LOOP),
    ),
    "a state that must be left but cannot be is a time-lock": (
        *(LOCKED, "A[] not (deadlock and A.b)", Ending.TIME_LOCK),
    ),
    "a time-lock refutes a leads-to": (LOCKED, "A.b --> A.c", Ending.TIME_LOCK),
    "a state without moves in which time passes is a deadlock": (
        *(IDLE, "A[] not deadlock", Ending.DEADLOCK),
    ),
    "a run may idle in a deadlock": (IDLE, "A<> A.b", Ending.IDLE),
}


@each("name", ENDINGS)
def test_a_counterexample_reports_how_it_ends(name):
    text, query, ending = ENDINGS[name]
    outcome = verify(loads_network(text), query)
    assert (outcome.holds, outcome.run.ending) == (False, ending)
    assert ("Zeno" in outcome.remark) == (ending is Ending.ZENO_LOOP)


def test_a_deadlock_in_part_of_a_zone_is_found():
    """Only some clock values are stuck."""
    network = loads_network("""clock x, y
    automaton A { location a invariant y <= 3  location b invariant y <= 3  start a
    edge a -> b when x >= 1 do x = 0  edge b -> b when x == 2 do x = 0, y = 0 }""")
    assert verify(network, "E<> A.b and y <= 1 and not deadlock").holds
    outcome = verify(network, "E<> A.b and deadlock")
    assert (outcome.holds, outcome.run.steps[0].window.low) == (True, 1)


@pytest.mark.parametrize(
    "text",
    [
        "clock x automaton A { location a invariant x < 0 start a }",
        "int[0,1] v automaton A { location a invariant v == 1 start a }",
    ],
)
def test_a_model_that_cannot_start_is_refused(text):
    network = loads_network(text)
    with pytest.raises(ModelError, match="of the initial locations is false at time 0"):
        build_suite(network, Criterion.EDGES)
    (diagnostic,) = findings_of(verify, network, "E<> A.a")
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
    network = loads_network(text)
    assert verify(network, "E<> deadlock").run.ending is Ending.TIME_LOCK
    assert not verify(network, "A[] not deadlock").holds
    assert verify(network, "E[] A.a").holds
