"""Path operators inside path operators are decided where that is sound, and refused elsewhere."""

import pytest

from rvmon.errors import ModelError
from rvmon.timed.language.load import loads_network
from rvmon.timed.search.verify import verify

TRAP = """
clock x
automaton A {
  location start
  location open
  location trap
  start start
  edge start -> open when x >= 1 do x = 0
  edge open -> start when x <= 4 do x = 0
  edge open -> trap when x >= 5
}
"""


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ("A[] (E<> A.trap)", True),
        ("A[] (E<> A.start)", False),
        ("AG EF A.trap", True),
        ("A[] (A.open and x <= 4 imply EF A.start)", True),
        ("A[] (A.open imply EF A.start)", False),
        ("E<> (A[] not A.start)", True),
        ("E<> (A.open and (A[] not A.start))", True),
        ("E<> (A.open and x <= 4 and (A[] not A.start))", False),
        ("A[] (A.open imply (A<> A.trap))", False),
        ("A[] (A.trap imply (A<> A.trap))", True),
        ("A[] (A.open imply A<> A.trap)", False),
        ("A[] (A.trap imply A<> A.trap)", True),
        ("E<> (A.open and (E[] A.open))", True),
        ("A[] ((A.trap imply AF A.trap) and EF A.trap)", True),
        ("E<> (EF (A.trap and x < 6) and AG not A.start)", True),
    ],
)
def test_nests_are_decided(query, expected):
    """Answers that can be read off the model."""
    assert verify(loads_network(TRAP), query).holds is expected


def test_the_run_leads_to_where_the_inner_formula_holds():
    """A counterexample of A[] (E<> p) ends where p cannot be reached any more."""
    outcome = verify(loads_network(TRAP), "A[] (A.open imply EF A.start)")
    assert outcome.run.steps[-1].window.low == 4
    assert outcome.run.duration > 5


@pytest.mark.parametrize(
    "query",
    [
        "A<> (E<> A.trap)",
        "E[] (E<> A.trap)",
        "A[] (A.open imply (A<>[<=3] (E<> A.trap)))",
        "E<>[<=3] (A[] A.trap)",
        "A.open --> (E<> A.trap)",
        "E<> (A.open and (E[] A.open) and (E[] A.trap))",
        "A<> deadlock",
        "deadlock --> A.trap",
        "A.open",
    ],
)
def test_what_is_not_decided_is_refused(query):
    """Other nests, and `deadlock` where runs must go on, are findings and no wrong answers."""
    with pytest.raises(ModelError) as caught:
        verify(loads_network(TRAP), query)
    assert caught.value.diagnostics[0].code == "TA020"


def test_a_nest_without_brackets_is_fixed():
    """The message says that an inner operator of UPPAAL's kind takes brackets elsewhere."""
    with pytest.raises(ModelError) as caught:
        verify(loads_network(TRAP), "A[] (A.open or A<> A.trap)")
    assert "brackets: (A<> …)" in caught.value.diagnostics[0].help
