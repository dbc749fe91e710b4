"""The nearest miss of a trigger that never came true."""

from tests.tools.each import each

from rvmon import loads
from rvmon.analysis.subformulas import why_not_triggered
from rvmon.trace.sample import Sample

SPEC = """
spec s
signal a, b, c : bool
signal x : real
event e, f
requirement R1 "x"
  upon {}
  then within 1 s a
"""

CASES = {
    "one part lacks at the best moment": (
        "e and a and b",
        [(0, {"a": True, "b": False, "c": True}), (5, {"e": True}), (7, {"b": True, "a": False})],
        "`b` was never true while `e and a` was (first at 5 ns)",
    ),
    "two parts lack": (
        "e and a and b",
        [(0, {"a": False, "b": False}), (5, {"e": True})],
        "`a` or `b` was never true while `e` was (first at 5 ns)",
    ),
    "a level that was false, then unknown": (
        "a",
        [(0, {"a": False}), (5, {"a": None})],
        "`a` was never known to be true",
    ),
    "a level that was unknown throughout": ("a", [(0, {"a": None})], "`a` never had a value"),
    "a comparison of what never came": (
        "x < 3 and not b",
        [(0, {"b": True})],
        "`x < 3` was never known; `not b` was never true; `x` never had a value",
    ),
    "an input that never came": (
        "e and a",
        [(0, {"b": True})],
        "`e` never occurred; `a` never had a value",
    ),
    "an input unknown at the best moment": (
        "e and a",
        [(0, {"a": False}), (3, {"a": None}), (5, {"e": True})],
        "`a` was never known to be true while `e` was (first at 5 ns)",
    ),
    "the nearer of two ways": (
        "(e and a and b) or (f and c)",
        [(0, {"a": False, "b": False, "c": True})],
        "`f` was never true while `c` was (first at 0 s)",
    ),
    "true, but no edge": (
        "a",
        [(0, {"a": False}), (1, {"a": None}), (2, {"a": True})],
        "its trigger was true at 2 ns, but not known to be false before: no edge was seen",
    ),
}


@each("name", CASES)
def test_what_the_trigger_lacked(name):
    trigger, rows, expected = CASES[name]
    spec = loads(SPEC.format(trigger)).checked
    samples = [Sample(t, values) for t, values in rows]
    assert why_not_triggered(spec, spec.requirements["R1"], samples, samples[-1].t) == expected


def test_a_name_without_a_source_is_never_known():
    spec = loads(SPEC.format("a and b")).checked
    samples = [Sample(0, {"a": True})]
    found = why_not_triggered(spec, spec.requirements["R1"], samples, 9, frozenset({"a"}))
    assert found == "`b` was never known to be true while `a` was (first at 0 s)"
