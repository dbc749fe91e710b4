"""CTL formulas with nested path operators."""

import pytest
from tests.tools.each import each
from tests.tools.findings import findings_of

from rvmon.models.language.load import loads_network
from rvmon.models.search.verify import verify

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


@each(
    ("query", "expected"),
    [
        ("A[] (E<> A.start)", False),
        ("E<> (A.open and (E[] A.open))", True),
        ("E<> (EF (A.trap and x < 6) and AG not A.start)", True),
        ("A<> (E<> A.trap)", True),
        ("AG AF A.start", False),
        ("EG EF A.trap", True),
        ("E<>[<=3] (A[] A.trap)", False),
        ("A[] (A.open imply (A<>[<=3] (E<> A.trap)))", True),
        ("A.open --> (E<> A.trap)", True),
        ("A<> deadlock", False),
        ("A[not A.open U A.start]", True),
        ("A[A.start U A.open]", False),
        ("E[not A.open U A.trap]", False),
        ("E[not A.trap U A.open]", True),
        ("E[A.start U[<=0] A.open]", False),
        ("E[A.open W A.trap]", False),
        ("EX A.open", True),
        ("AX (A.open and EX A.trap)", True),
        ("(E<> A.trap) imply (A<> A.trap)", False),
        ("EF[<=5] A.trap or EF[<=6] A.trap", True),
    ],
)
def test_nested_formulas(query, expected):
    """Forms that do not occur in the random models, which are compared with regions."""
    assert verify(loads_network(TRAP), query).holds is expected


def test_the_counterexample_leads_to_where_the_inner_formula_fails():
    outcome = verify(loads_network(TRAP), "A[] (A.open imply EF A.start)")
    assert outcome.run.steps[-1].window.low == 4
    assert outcome.run.duration > 5


def test_a_value_out_of_range_is_found_when_a_nested_formula_is_decided():
    network = loads_network(
        "int[0,1] v\nautomaton A { location a start a edge a -> a do v = v + 1 }"
    )
    assert findings_of(verify, network, "EG EF A.a")[0].code == "TA007"


@pytest.mark.parametrize(
    ("query", "said"),
    [("A.open", "TA020"), ("A[] (A.open or A<> A.trap)", "brackets: (A<> …)")],
)
def test_a_query_without_a_path_operator_or_brackets_is_refused(query, said):
    (diagnostic,) = findings_of(verify, loads_network(TRAP), query)
    assert said in f"{diagnostic.code}: {diagnostic.help}"
