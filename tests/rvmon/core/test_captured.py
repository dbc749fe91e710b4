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


@pytest.mark.parametrize("only", [["R2"], ["R3"], ["R4"]])
def test_many_at_once_and_forgotten(only):
    """There is room for all; an instance that is over begins anew."""
    spec = rvmon.loads(SPEC)
    trace = [
        (0.25 * n, {"x": n % 7, "go": {"id": n % 90}, "done": {"id": (n * 7) % 50}})
        for n in range(300)
    ]
    found = outcomes(spec.evaluate(trace, only=only))
    assert len(found) > 30
    monitor = spec.monitor(only=only)
    for t, values in trace:
        monitor.step(t, values)
    assert outcomes(monitor.finish()) == found


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
    """Captured values stand in the JSON text of an attempt, by name."""
    spec = rvmon.loads(SPEC)
    trace = [(0, {"x": 1.5, "mode": "red", "go": True}), (1, {"x": 2, "go": {"id": 4}})]
    found = json.loads(spec.evaluate(trace).to_json())
    captured = [one["captured"] for one in found["requirements"]["R2"]["attempts"]]
    assert captured == [{"a": 1.5, "m": "red"}, {"a": 2.0, "m": "red"}]


def test_what_came_since_the_last_tick_belongs_to_the_instance_that_begins_at_the_next():
    """The trigger comes first, then the value of `for each`, both before a tick of the clock."""
    spec = rvmon.loads(
        "spec s\ntime sampled every 3 ns\nevent h\nevent g(k: int)\n"
        "requirement R\n  upon h\n  then true\n  for each key in g.k\n"
    )
    monitor = spec.monitor()
    monitor.step_ns(10, {"h": True})
    decided = [*monitor.step_ns(11, {"g": {"k": -2}}), *monitor.step_ns(15, {})]
    assert [(one.triggered, one.captured, one.verdict) for one in decided] == [
        (12, {"key": -2}, "P")
    ]


@pytest.mark.parametrize(
    ("each", "other"), [("g.k", "h.m"), ("h.m", "g.k")], ids=["whole key", "real key"]
)
def test_a_field_of_another_kind_may_name_an_instance(each, other):
    """The numbers 1 and 1.0 are one."""
    spec = rvmon.loads(
        "spec s\nevent g(k: int)\nevent h(m: real)\nevent q\n"
        f"requirement R\n  upon q\n  then eventually {other} == key\n  for each key in {each}\n"
    )
    event, field = each.split(".")
    named, its = other.split(".")
    samples = enumerate([{event: {field: 1}, "q": True}, {}, {named: {its: 1}}])
    case = Case(spec.checked, tuple(Sample(t, values) for t, values in samples), None)
    assert disagreements(case, Maker(), online=False) == []


def test_a_window_over_what_can_never_be_is_captured_all_the_same():
    """What it reads has its place in the plan, though no formula is left that reads it."""
    spec = rvmon.loads("""spec s
time sampled every 3 ns
signal p : bool
signal x : real
requirement R
  upon start
  then immediately 1 <= v
  let v = 1 + integral(if once[2 ns, 2 ns] p then max(x, x) else 0, 3 ns) / 1 s
""")
    [attempt] = spec.evaluate([(0, {"p": True, "x": 3.0})]).attempts
    assert (attempt.verdict, dict(attempt.captured)) == (rvmon.Verdict.PASS, {"v": 1.0})
