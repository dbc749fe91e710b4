"""Coverage of requirements by runs."""

import random

import pytest

from rvmon import loads
from rvmon.coverage import score
from rvmon.language.checked.properties import BinKind

ANSWER = """signal a, b, c : bool
requirement R upon a then within 2 s b
"""


def seen(text, samples, group="R", end=None):
    """The hits of each item."""
    spec = loads(text)
    hits = spec.coverage_model.of(spec.recording(samples), end)
    return {item: hit.count for item, hit in hits.get(group, {}).items()}


def answered(after):
    """A trigger at 1 s and an answer some seconds later."""
    return [(0, {"a": False, "b": False}), (1, {"a": True}), (1 + after, {"b": True}), (9, {})]


def test_deadlines():
    assert seen(ANSWER, answered(1)) == {"triggered": 1, "passed": 1}
    assert "just before the deadline" in seen(ANSWER, answered(1.8))
    assert "just before the deadline" not in seen(ANSWER, answered(2))
    assert "at the deadline" in seen(ANSWER, answered(2))
    assert seen(ANSWER, answered(2.000000001)) == {"triggered": 1, "after the deadline": 1}


def test_items_that_only_failures_hit_have_no_goal():
    """A run without failures can reach all goals."""
    spec = loads(ANSWER)
    groups = spec.coverage_model.model.groups
    early = [(0, {"a": True, "b": True}), (0.5, {"a": False, "b": False})]
    late = [(t + 1, values) for t, values in [*answered(2)]]
    near = [(t + 20, values) for t, values in answered(1.9)]
    hits = spec.coverage([*early, *late, *near])
    for name in ("R", "`R` locations", "`R` edges"):
        found = score(hits, groups[name])
        assert found.covered == found.items > 0


def test_parts_that_decide():
    text = """signal a, b, c : bool
requirement R upon a and c then within 2 s (b and c)
"""
    always_c = [(0, {"a": False, "b": False, "c": True}), (1, {"a": True}), (2, {"b": True})]
    assert seen(text, always_c) == {
        "triggered": 1,
        "passed": 1,
        "`a` decides": 2,
        "`b` decides": 2,
    }
    never_c = [(0, {"a": False, "b": True, "c": False}), (1, {"a": True}), (5, {})]
    assert seen(text, never_c) == {"`c` decides": 1}


FORMS = """signal a, b, c : bool
requirement A1 upon rise(a) then immediately (b and not (a and c) or once[0 s, 2 s] (b and c))
requirement A2 upon rise(a) then always (b and (a -> c) and not (a xor b and c))
requirement A3 upon rise(a) then always[1 s, 3 s] not (b or c)
requirement A4 upon a and b then always[0 s, 2 s] once[0 s, 3 s] (b and c)
"""


@pytest.mark.slow
def test_parts_that_only_failures_decide_have_no_goal():
    """Only runs with failures hit them."""
    rng = random.Random(1)
    spec = loads(FORMS)
    groups = spec.coverage_model.model.groups
    quiet = {
        (name, item.name)
        for name in spec.requirements
        for item in groups[name].items.values()
        if item.name.endswith("decides") and item.kind is BinKind.IGNORE
    }
    assert {
        name: [part for of, part in sorted(quiet) if of == name] for name in spec.requirements
    } == {
        "A1": ["`b (2)` decides", "`b` decides", "`c (2)` decides", "`not (a and c)` decides"],
        "A2": ["`a -> c` decides", "`b` decides", "`not (a xor b and c)` decides"],
        "A3": ["`b` decides", "`c` decides"],
        "A4": [],
    }
    missing = set(quiet)
    for _ in range(300):
        samples = [(t, {n: rng.random() < 0.5 for n in "abc"}) for t in range(rng.randint(1, 8))]
        hits = spec.coverage_model.of(spec.recording(samples), None)
        verdicts = spec.evaluate(samples).verdicts
        shown = {(name, item) for name, item in quiet if item in hits.get(name, {})}
        assert all(verdicts[name] == "F" for name, _ in shown)
        missing -= shown
    assert missing == {("A1", "`not (a and c)` decides"), ("A2", "`a -> c` decides")}  # others do


def test_automata():
    """There is no edge to `P` if only the end of the run can meet the consequent."""
    assert seen(ANSWER, answered(1), "`R` edges") == {"start → A": 1, "A → P": 1}
    assert seen(ANSWER, answered(1), "`R` locations").keys() == {"start", "A", "P"}
    spec = loads("signal a, b : bool\nrequirement R\n  upon a\n  then always not b\n")
    assert [*spec.coverage_model.model.groups["`R` locations"].items] == ["start", "A", "F"]


def test_attempts_in_doubt_hit_nothing():
    """It is not known that there was an attempt, nor which locations it visited."""
    samples = [(0, {"a": None, "b": False}), (1, {"b": True}), (5, {})]
    assert seen(ANSWER, samples) == {}
    assert seen(ANSWER, samples, "`R` edges") == {}


def test_requirements_without_automaton_and_with_instances():
    """Networks have no locations; all instances of a requirement are counted together."""
    text = """signal a, b : bool
event pick(id: int)
event put(id: int)
requirement Net whenever a then F[2 s, 5 s] b
requirement Each upon pick.id == i then within 2 s put.id == i for each i in pick.id
"""
    spec = loads(text)
    assert {"Net", "Each", "`Each` edges"} <= spec.coverage_model.model.groups.keys()
    assert "`Net` edges" not in spec.coverage_model.model.groups
    samples = [(0, {"a": False, "b": False}), (1, {"pick": {"id": 1}}), (1.5, {"pick": {"id": 2}})]
    samples += [(2, {"put": {"id": 1}}), (2.5, {"put": {"id": 2}})]
    hits = spec.coverage(samples)
    assert hits["Each"]["passed"].count == hits["`Each` edges"]["A → P"].count == 2


def test_names_of_groups_are_not_names_of_requirements():
    text = ANSWER + "requirement `R edges`\n  always a\n"
    groups = loads(text).coverage_model.model.groups
    assert {"R", "`R` edges", "R edges", "`R edges` edges"} <= groups.keys()
