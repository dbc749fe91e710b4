"""Requirements with `let` and `for each` in the core: a run for each instance and attempt."""

import json
import random
import re
from dataclasses import replace

import pytest
from tests.tools.compare import outcomes
from tests.tools.differential import disagreements
from tests.tools.forms import FORMS, Maker
from tests.tools.law import judge

import rvmon
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample

SPEC = """
spec s
signal x : real
signal mode : {red, green}
event go(id: int)
event done(id: int)
requirement R1 "nothing is captured"
  whenever x > 5
  then within 3 s x < 3
requirement R2 "values"
  upon go
  then within 3 s (x > a and mode == m)
  let a = x
  let m = mode
requirement R3 "instances"
  upon go
  then within 2 s done.id == k
  for each k in go.id
requirement R4 "both, looking at what was before"
  whenever go and once[0 s, 3 s] done.id == k
  then F[0 s, 2 s] once[0 s, 1 s] x > a
  for each k in go.id
  let a = x / 3
"""


@pytest.mark.law
@pytest.mark.parametrize("name", ["R2", "R3", "R4"])
def test_instances_that_come_again_are_judged_as_the_law_has_it(name):
    """A value that was over is one more instance; it is told which attempt is whose."""
    spec = rvmon.loads(re.sub(r"(\d) s\b", r"\1 ns", SPEC))
    checked = replace(spec.checked, requirements={name: spec.checked.requirements[name]})
    samples = tuple(
        Sample(2 * n, {"x": n % 7, "go": {"id": n % 11}, "done": {"id": (n * 7) % 9}})
        for n in range(60)
    )
    case = Case(checked, samples, None)
    assert len(outcomes(judge(case))) > 5
    for form in FORMS:
        assert disagreements(case, Maker(form)) == []


@pytest.mark.parametrize("many", [2, 7, pytest.param(70, marks=pytest.mark.slow)])
def test_those_that_become_sure_at_once_are_numbered_by_their_triggers(many):
    """Whatever the order of their instances; it is that of what began in doubt, too."""
    spec = rvmon.loads(
        "spec s\ntime sampled\nsignal x : real\nevent g(k: int)\nevent o(k: int)\n"
        "requirement R\n  whenever x > 1 and once o.k == key\n  then x < 5\n"
        "  for each key in g.k\n"
    )
    rng = random.Random(many)
    keys = list(range(many))
    asked = [{"g": {"k": key}} for key in keys]
    rng.shuffle(keys)
    found = [{"o": {"k": key}} for key in keys]
    values = [{"x": 0.0}, {"x": None}, *asked, *found, {"x": 2.0}, {"x": 0.0}, {"x": None}, {}]
    samples = tuple(Sample(t, values) for t, values in enumerate(values))
    report = spec.evaluate([(one.t * 1e-9, one.values) for one in samples])
    assert outcomes(report) == outcomes(judge(Case(spec.checked, samples, None)))
    assert [one.in_doubt for one in report.attempts].count(False) == many


def test_reports_as_json_say_what_was_captured():
    spec = rvmon.loads(SPEC)
    trace = [(0, {"x": 1.5, "mode": "red", "go": True}), (1, {"x": 2, "go": {"id": 4}})]
    found = json.loads(spec.evaluate(trace).to_json())
    captured = [one["captured"] for one in found["requirements"]["R2"]["attempts"]]
    assert captured == [{"a": 1.5, "m": "red"}, {"a": 2.0, "m": "red"}]
