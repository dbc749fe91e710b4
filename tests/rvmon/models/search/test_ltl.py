"""LTL formulas on all runs, also under assumptions, with counterexamples."""

import pytest
from tests.tools.each import each

from rvmon.errors import ModelError
from rvmon.models.language.load import loads_network
from rvmon.models.runs import Ending
from rvmon.models.search.verify import verify

RETRY = """
clock x
chan go
automaton A {
  location asked invariant x <= 5
  location failed invariant x <= 5
  location done
  start asked
  edge asked -> failed when x >= 1 do x = 0
  edge failed -> asked when x >= 1 do x = 0
  edge asked -> done
}
"""


@each(
    ("query", "expected"),
    [
        ("G F A.asked", False),
        ("F G A.done or G F A.failed", True),
        ("F A.done assuming not (G F A.failed)", True),
        ("A<> A.done assuming F G not A.failed", True),
        ("A.asked --> A.done assuming G F A.failed", False),
        ("E<> A.done assuming G F A.failed", False),
        ("E (G F A.failed and G not A.done)", True),
        ("A ([] (A.failed imply <> A.asked))", True),
        ("(not A.done W A.failed)", False),
        ("A[A.asked U A.done]", False),
        ("G (A.failed and x > 2 imply F (A.asked and x < 1))", True),
        ("E (F G (A.failed and x <= 4))", False),
        ("E (A.asked W F (A.done and x > 2))", True),
        ("E (not A.failed and x < 4 W F (A.failed and x > 5))", False),
    ],
)
def test_formulas_have_the_known_answer_and_a_run_that_shows_it(query, expected):
    outcome = verify(loads_network(RETRY), query)
    assert outcome.holds is expected
    assert (outcome.run is not None) == (expected == query.startswith("E"))


def test_a_loop_on_which_time_passes_is_preferred():
    lazy = "clock x automaton A { location a start a edge a -> a edge a -> a when x >= 1 do x = 0 }"
    assert verify(loads_network(lazy), "F x > 9").run.ending is Ending.LOOP
    hasty = "clock x automaton A { location a invariant x <= 1 start a edge a -> a }"
    outcome = verify(loads_network(hasty), "G F x == 0")
    assert outcome.run.ending is Ending.ZENO_LOOP
    assert "Zeno" in outcome.remark


@each(
    ("query", "message"),
    [
        ("G X (A.done)", "no next instant"),
        ("G (A.asked imply AF A.done)", "CTL"),
        ("F deadlock", "deadlock"),
        ("A (A.done)", "refers to runs"),
        ("A.done assuming G F A.asked", "whole runs"),
        ("E<> (F A.done)", "CTL"),
    ],
)
def test_an_unsupported_formula_says_why(query, message):
    with pytest.raises(ModelError, match=message):
        verify(loads_network(RETRY), query)


@pytest.mark.slow
def test_a_formula_with_too_many_cases_is_refused_with_its_place():
    parts = " and ".join(f"(F v == {number})" for number in range(8))
    model = loads_network(f"int[0,9] v {RETRY}query q: E ({parts})")
    with pytest.raises(ModelError, match=r"too many cases\n.*:13:1\n"):
        verify(model, model.queries[0])


def test_variables_may_be_called_like_temporal_operators():
    text = "int[0,1] G\nint[0,1] F = 1\nint[0,1] U\nautomaton A { location a start a }"
    network = loads_network(text)
    assert verify(network, "A[] (G < F and U == G)").holds
    assert verify(network, "G (G == 0 and F == 1)").holds
