"""A lower bound in an invariant acts as a guard on the edges into its location."""

import pytest
from tests.tools.each import each

from rvmon.errors import ModelError
from rvmon.models.language.load import loads_network
from rvmon.models.search.verify import verify


def model(invariant, update="", other="", channel=""):
    do, on = (f"{word} {text}" if text else "" for word, text in (("do", update), ("on", channel)))
    return f"""clock x, y
int[0,3] v
urgent chan hurry
broadcast chan all
automaton A {{ location l location m invariant {invariant} start l edge l -> m {on} {do} }}
{other}"""


@each(
    ("invariant", "update", "query", "holds"),
    [
        ("x >= 3", "", "E<> A.m and x < 3", False),
        ("x >= 3", "", "E<> A.m and x <= 3", True),
        ("x > 3", "", "E<> A.m and x <= 3", False),
        ("x >= 3 and x <= 4", "", "A<> A.m", False),
        ("x >= 3", "x = 0", "E<> A.m", False),
        ("x >= 3", "x = 3", "E<> A.m and y < 3", True),
        ("x >= 3", "x = 3, x = 2", "E<> A.m", False),
        ("x == 3", "", "E<> A.m and deadlock and x == 3", True),
    ],
)
def test_a_lower_bound_holds_on_entry(invariant, update, query, holds):
    assert verify(loads_network(model(invariant, update)), query).holds is holds


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"invariant": "x >= v"}, "not constant"),
        ({"invariant": "x >= 1", "update": "x = v"}, "computed"),
        ({"invariant": "x >= 1", "channel": "all?"}, "urgent or broadcast"),
        ({"invariant": "x >= 1", "channel": "hurry!"}, "urgent or broadcast"),
        (
            {
                "invariant": "x >= 1",
                "other": "automaton B { location l start l edge l -> l do x = 0 }",
            },
            "another automaton sets",
        ),
    ],
)
def test_a_lower_bound_that_cannot_become_a_guard_is_refused(parts, message):
    with pytest.raises(ModelError, match=message) as caught:
        loads_network(model(**parts))
    assert caught.value.diagnostics[0].code == "TA009"
