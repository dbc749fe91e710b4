"""`monitor as cover`: properties of some path as goals, and what no single run shows."""

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
def test_what_one_run_shows_is_a_goal(text):
    """It is no requirement, so that no run fails it."""
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
def test_what_no_run_shows_is_refused(text, message):
    with pytest.raises(SpecError, match=message):
        loads(f"{HEAD}  {text}")


def test_a_run_shows_it_or_not(tmp_path, says):
    """A run that shows the goal passes it, none fails it; a property alone is told as unjudged."""
    spec = tmp_path / "s.rv"
    spec.write_text(f"{HEAD}  property E<> (a and b)\nproperty ALONE: E<> c", "utf-8")
    for last, answer in (("1,1", "R1  P"), ("1,0", "R1  I")):
        trace = tmp_path / "t.csv"
        trace.write_text(f"t,a,b,c\n0,0,0,0\n1,{last},0\n", "utf-8")
        told = says(0, "run", spec, trace)
        assert answer in told.out
        assert "`ALONE`" in told.err
