"""`monitor as cover`: existential properties as coverage goals, and what no single run can show."""

import pytest
from tests.tools.each import each

from rvmon import loads
from rvmon.errors import SpecError
from rvmon.language.print import format_formula

HEAD = "spec s\ntime sampled\nsignal a, b, c : bool\nrequirement R1\n  monitor as cover\n"

SHOWN = {
    "E<> (a and b)": "not always not (a and b)",
    "E[a U b]": "not (not a R not b)",
    "EF (a and EF b)": "not always (not a or always not b)",
    "EX a": "not next not a",
}


@pytest.mark.parametrize("text", SHOWN)
def test_a_property_that_one_run_shows_is_a_goal(text):
    """A goal is not a requirement: no run fails it."""
    spec = loads(f"{HEAD}  property {text}")
    assert not spec.requirements
    goal = spec.checked.covers["R1"]
    assert format_formula(goal.formula) == SHOWN[text]
    assert spec.checked.properties["R1"] is goal.ctl


@each(
    ("text", "message"),
    [
        ("property A[] a", "no single run can show"),
        ("property EG EF a", "no single run can show"),
        ("property E<> (AF a)", "no single run can show"),
        ("property E<> Door.open", "reads a clock or location of a model"),
        ('source "x"', "no property that runs should show"),
        ("property E<> a\n  at end: fail", "a goal has no attempts"),
    ],
)
def test_a_property_that_no_single_run_shows_is_refused(text, message):
    with pytest.raises(SpecError, match=message):
        loads(f"{HEAD}  {text}")


def test_a_run_shows_it_or_not(tmp_path, says):
    """A run that shows the goal passes it; properties without a monitor are not judged."""
    spec = tmp_path / "s.rv"
    spec.write_text(f"{HEAD}  property E<> (a and b)\nproperty ALONE: E<> c", "utf-8")
    for last, answer in (("1,1", "R1  P"), ("1,0", "R1  I")):
        trace = tmp_path / "t.csv"
        trace.write_text(f"t,a,b,c\n0,0,0,0\n1,{last},0\n", "utf-8")
        told = says(0, "run", spec, trace)
        assert answer in told.out
        assert "`ALONE`" in told.err
