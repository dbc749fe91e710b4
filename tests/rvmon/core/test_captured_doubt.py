"""Where it is not known which values an attempt captured, nothing is said of what it owes."""

import pytest
from tests.tools.differential import disagreements
from tests.tools.forms import Maker

import rvmon
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample

HEAD = "spec s\ntime {}\nsignal q : bool\nsignal x : real\nevent e\nevent g(k: int)\n"
CASES = {
    "the trigger is what is required": (
        "sampled",
        "whenever e\n  then always e\n  let v = x",
        [(-3, {"e": True}), (0, {"e": None})],
    ),
    "nothing can fail": (
        "held",
        "whenever e\n  then always[2 ns, inf) true\n  let v = g.k",
        [(0, {"e": None}), (1, {})],
    ),
    "it fails where it begins": (
        "sampled",
        "whenever (q or g.k == i)\n  then start\n  for each i in g.k\n  let v = x",
        [(0, {"q": True}), (1, {"q": None}), (3, {"g": {"k": 1}})],
    ),
    "it looks back where it begins": (
        "sampled",
        "whenever (q or g.k == i)\n  then previous false\n  for each i in g.k\n  let v = x",
        [(0, {"q": True}), (1, {"q": None}), (3, {"g": {"k": 1}})],
    ),
    "the end fails what has not ended": (
        "held",
        "whenever (once e) or g\n  then true\n  for each i in g.k\n  let v = x\n  at end strong",
        [(0, {"g": {"k": None}}), (1, {"g": {"k": 6}, "e": True})],
    ),
    "a key that is not known": (
        "held",
        "whenever true\n  then true\n  for each i in g.k\n  let v = g.k",
        [(0, {}), (1, {"g": {"k": None}})],
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_what_was_captured_in_doubt_decides_nothing(name):
    """Each case once was decided, or an error."""
    time, requirement, samples = CASES[name]
    spec = rvmon.loads(f"{HEAD.format(time)}requirement R\n  {requirement}\n")
    case = Case(spec.checked, tuple(Sample(t, values) for t, values in samples), None)
    assert disagreements(case, Maker(), online=True) == []
    monitor = spec.monitor()
    for t, values in samples:
        monitor.step_ns(t, values)
    assert monitor.finish_ns().verdicts["R"].value == "I"
