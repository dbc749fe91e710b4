"""Shrunk cases in which a monitor once departed from the oracle."""

from dataclasses import replace

import pytest
from tests.tools.build import (
    always,
    compared,
    e,
    end,
    eventually,
    f,
    fall,
    false,
    following,
    g,
    k,
    no,
    p,
    previous,
    q,
    r,
    requirement,
    spec_of,
    start,
    timeline,
    true,
    two,
    x,
    y,
)
from tests.tools.differential import disagreements

import rvmon
from rvmon import loads
from rvmon.monitor import build_monitor, compile_spec
from rvmon.spec.checked.formula import Captured
from rvmon.spec.checked.specification import Capture, EndPolicy, ForEach, TimeModel
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample

EACH = ForEach("each", k)
OF_X = (Capture("v", x),)
OF_K = (Capture("v", k),)
BOTH_AT_1 = (Sample(0, {"f": True}), Sample(1, {"f": True, "g": {"k": 0}}))

CASES = {
    "an event that was not known occurs at the next position": (
        requirement(p, upon=e),
        timeline(e="u10u1", p="10010"),
    ),
    "the position before the first, asked for the future": (
        requirement(two(previous(eventually(q, 0, 1)), "or", no(previous(eventually(p, 0, 1))))),
        timeline(p="101", q="010"),
    ),
    "the position before, asked for the future at each": (
        requirement(previous(eventually(q, 0, 1)), whenever=p),
        timeline(p="111", q="111"),
    ),
    "an invariant alone goes on after each failure": (
        requirement(q, whenever=p),
        timeline(p="1111101", q="1010110"),
    ),
    "what comes when an episode is over takes nothing from the values it captured": (
        requirement(eventually(compared(y, "==", Captured("v")), 0, 6), whenever=p, captures=OF_X),
        timeline(p="10u..", x="12222", y="000010"),
    ),
    "an episode of values not known any more that was over when the trigger was lost": (
        requirement(
            eventually(compared(y, "==", Captured("v"))),
            whenever=p,
            captures=OF_X,
            at_end=EndPolicy.FAIL,
        ),
        timeline(p="1u0u.", x="12222", y="00000"),
    ),
    "an episode with captured values goes on after a failure": (
        requirement(compared(y, "==", Captured("v")), whenever=p, captures=OF_X),
        timeline(p="11111", x="11111", y="10110"),
    ),
    "an episode fails and goes on while an attempt of the one before is open": (
        requirement(two(q, "and", eventually(r, 0, 5)), whenever=p),
        timeline(p="101111", q="111011", r="000000"),
    ),
    "an episode of a known trigger that began before what is required was born": (
        requirement(eventually(compared(y, ">", 3)), whenever=p, at_end=EndPolicy.FAIL),
        timeline(p="111", y=".01"),
    ),
    "a window opened between two samples": (
        requirement(two(true, "U", true, 2, 4)),
        (Sample(0, {}), Sample(1, {}), Sample(4, {})),
    ),
    "a window opened by advance": (
        requirement(always(false, 3, 5)),
        (Sample(0, {}), Sample(2, {}), 3, Sample(5, {})),
    ),
    "a captured attempt moves with each sample": (
        requirement(following(true), captures=OF_X),
        (Sample(0, {}), Sample(1, {})),
    ),
    "an instance that is made while another has an occurrence": (
        requirement(true, upon=g, for_each=EACH),
        (Sample(-2, {"g": {"k": -2}}), Sample(0, {"g": {"k": -1}})),
    ),
    "two instances before the first tick of the clock": (
        requirement(p, upon=compared(k, ">", -1), for_each=EACH),
        (Sample(7, {"p": False}), Sample(8, {"g": ({"k": 1}, {"k": 0})})),
    ),
    "an episode that ran before the instance was there": (
        requirement(fall(false), whenever=f, for_each=EACH),
        BOTH_AT_1,
    ),
    "an occurrence that is over at the end": (
        requirement(compared(k, "<", 0), upon=end, captures=OF_K),
        (Sample(0, {"g": {"k": -1}}),),
    ),
    "a sample that no tick has shown yet": (
        requirement(p, upon=end, captures=OF_X),
        (Sample(0, {}), Sample(3, {"p": True})),
    ),
    "time that has come to zero, behind the end": (
        requirement(eventually(false, 0, 0), upon=end),
        (Sample(-3, {}), 0),
    ),
    "values that may be others in an episode that may be over": (
        requirement(eventually(false, 0, 9), whenever=f, captures=OF_K, at_end=EndPolicy.STRONG),
        (Sample(0, {"f": True, "g": {"k": 1}}), Sample(1, {"f": None})),
    ),
    "values that may be others in an episode that is over": (
        requirement(eventually(false, 0, 9), whenever=f, captures=OF_K, at_end=EndPolicy.STRONG),
        (Sample(0, {"f": True}), Sample(1, {"f": None}), Sample(2, {"f": False})),
    ),
    "an event that is unknown to one reading only": (
        requirement(two(eventually(e, 0, 2), "and", always(p, 1, 3)), upon=start),
        (Sample(0, {"e": None, "p": True}), Sample(2, {"p": None}), Sample(3, {"p": True})),
    ),
}


@pytest.mark.law
@pytest.mark.parametrize("time", TimeModel)
@pytest.mark.parametrize("name", CASES)
def test_corner(name, time):
    """The core agrees with the oracle, call by call, in each time model that has the formula."""
    judged, actions = CASES[name]
    if time is TimeModel.HELD and "moves with each sample" in name:
        judged = replace(judged, consequent=eventually(p, 1, 1))
    spec = spec_of(judged, time=time, period=4 if time is TimeModel.CLOCKED else None)

    def make(case):
        return build_monitor(compile_spec(case.spec), sources=case.names)

    for finish in (None, 2, 9):
        assert disagreements(Case(spec, actions, finish), make, online=True) == []


def test_what_is_read_twice_is_born_when_both_can_be_told():
    """With one value nothing was judged of its change, though all of the value itself."""
    spec = rvmon.loads(
        "spec s\nsignal v : real\nrequirement R1\n  always (delta(v) <= 1 and v <= 2)\n"
        "requirement R2\n  always v <= 2\n"
    )
    report = spec.evaluate({"t_ns": [0], "v": [1.0]})
    assert report.verdicts == {"R1": "I", "R2": "P"}


@pytest.mark.parametrize(("first", "expected"), [(0.5, "P"), (1.0, "P"), (1.1, "F")])
def test_an_age_counts_from_the_beginning_before_the_first_update(first, expected):
    """Nothing was due before; a sensor that begins too late has been silent."""
    spec = loads("spec s\nsignal x, y : real\nrequirement R\n  always age(x) <= 1 s\n")
    report = spec.evaluate([(0, {"y": 1.0}), (first, {"x": 1.0})])
    assert report.verdicts["R"] == expected


@pytest.mark.parametrize(
    ("trigger", "expected"),
    [
        ("p and lost", "I"),
        ("p and not lost", "I"),
        ("not p and lost", "NT"),
        ("lost since[1 s, inf) p", "I"),
    ],
)
def test_a_trigger_that_reads_what_has_no_source_may_have_been_true(trigger, expected):
    """It is neither false nor passed over, as what comes later would be."""
    text = f"spec s\nsignal p, lost : bool\nrequirement R\n  upon {trigger}\n  then not p\n"
    report = loads(text).evaluate({"t": [0, 1], "p": [True, True]}, allow_missing=["lost"])
    assert report.verdicts["R"] == expected
