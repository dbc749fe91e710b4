"""Instances of a `for each` that are over are dropped without any visible difference."""

import random
import re
from collections import Counter

import pytest
from tests.tools.compare import outcomes
from tests.tools.differential import disagreements
from tests.tools.forms import Compiler, Maker
from tests.tools.law import judge

import rvmon
from rvmon.testing.generate.trace import Case, TraceProfile, random_trace
from rvmon.trace.sample import Sample

HEAD = "signal ok : bool\nevent order(id: int)\nevent done(id: int)\n"
REQUIRED = {
    "another event with the key": "upon order\n  then within 3 s done.id == k",
    "a signal": "upon order\n  then within 3 s ok",
    "the past of a signal": "upon order and once[1 s, 3 s] ok\n  then for 2 s not done",
    "the past of the event": "upon order and not once[1 s, 4 s] order\n  then within 3 s ok",
    "a past that reads the key": (
        "upon order and not once[1 s, 9 s] done.id == k\n  then within 2 s ok"
    ),
    "episodes": "whenever order and ok\n  then within 2 s done.id == k",
    "a trigger without the key": "upon order or ok\n  then within 3 s done.id == k",
    "a captured value": (
        "upon order\n  then within 3 s (done.id == k and done.id == i)\n  let i = order.id"
    ),
    "the end": "upon end\n  then ok",
}


def text_of(required, time=""):
    return f"spec many\n{time}{HEAD}requirement R1\n  {required}\n  for each k in order.id\n"


def samples(rng, count):
    """Many keys, most of which occur once or twice, and a few unknown ones."""
    t = 0
    for number in range(count):
        t += rng.choice([1, 5, 10, 25])
        keys = [rng.choice([number, number - 1, number - 2, rng.randrange(6)]) for _ in "ab"]
        values = {}
        if rng.random() < 0.6:
            orders = [{"id": None if rng.random() < 0.03 else key} for key in keys]
            values["order"] = tuple(orders[: rng.choice([1, 1, 2])])
        if rng.random() < 0.5:
            values["done"] = {"id": rng.choice(keys)}
        if rng.random() < 0.3:
            values["ok"] = rng.choice([True, False, None])
        yield Sample(t, values)


@pytest.mark.law
@pytest.mark.parametrize("time", ["", "time sampled\n", "time sampled every 1 s\n"])
@pytest.mark.parametrize("name", REQUIRED)
def test_dropping_finished_instances_changes_no_record(name, time):
    text = re.sub(r"(\d) s\b", r"\g<1>0 ns", text_of(REQUIRED[name], time))
    checked = rvmon.loads(text).checked
    case = Case(checked, tuple(samples(random.Random(f"{name}/{time}"), 18)), None)
    compiler = Compiler()
    for form in ("c rows", "c+interrupt"):
        assert disagreements(case, Maker(form, compiler)) == []


COMPARED = {
    "a limit": "within 9 ns y > v + 1",
    "the limit first": "(v * 2 >= y) U[0 ns, 9 ns] n > w",
    "equal, unequal": "for 4 ns (y != v and n != w)",
    "two limits of one signal": "within 9 ns (y > v and y < v + 1)",
    "a limit that changes": "within 9 ns (y > v + x or abs(y - v) > 1)",
    "a limit and a constant": "for 9 ns (y <= v or y > 2)",
    "the past of a comparison": "within 9 ns (y < 1 and once[0 ns, 5 ns] (y > v))",
}


@pytest.mark.law
@pytest.mark.parametrize("each", ["upon e", "upon rise(y > 1)", "whenever x > 1"])
@pytest.mark.parametrize("required", COMPARED)
def test_comparisons_with_captured_values_agree_with_the_law(required, each):
    """The core visits only attempts in which a sample may change a comparison."""
    text = f"""signal x, y : real
signal n : int
event e
requirement R
  {each}
  let v = x
  let w = n
  then {COMPARED[required]}
"""
    checked = rvmon.loads(text).checked
    compiler = Compiler()
    for seed in range(6):
        case = random_trace(random.Random(seed), checked, TraceProfile(samples=25, fewest=20))
        for form in ("c", "c+interrupt"):
            assert disagreements(case, Maker(form, compiler)) == []


@pytest.mark.parametrize("restored", [False, True])
def test_hundreds_of_attempts_are_open_at_once(restored):
    """Most samples change a comparison in a few of them only, and all hold the new value."""
    spec = rvmon.loads("""signal x, y : real
event e
requirement R
  upon e
  let v = x
  then within 300 ns y > v
""")
    rng, y, rows = random.Random(5), 0.0, []
    for t in range(900):
        y += rng.uniform(-0.02, 0.02) + (1.0 if t == 700 else 0.0)
        rows.append((t, {"x": y + rng.expovariate(5), "y": y} | ({"e": {}} if t < 600 else {})))
    monitor, found = spec.monitor(), {}
    for t, row in rows:
        if restored and t % 100 == 50:
            monitor = spec.restore(monitor.snapshot())
        for attempt in monitor.step_ns(t, row):
            found[attempt.triggered] = (attempt.verdict, attempt.decided)
    expected = {}
    for t, row in rows[:600]:
        met = [u for u, later in rows[t : t + 301] if later["y"] > row["x"]]
        expected[t] = ("P", met[0]) if met else ("F", t + 301)
    assert found == expected


@pytest.mark.slow
@pytest.mark.parametrize("time", ["", "time sampled every 10 ms\n"])
@pytest.mark.parametrize("name", ["another event with the key", "the past of a signal", "episodes"])
def test_finished_instances_take_no_memory(name, time):
    monitor = rvmon.loads(text_of(REQUIRED[name], time)).monitor(keep=5)
    sizes = []
    for number in range(30_000):
        monitor.step(number, {"order": {"id": number}, "ok": number % 7 != 0})
        if number % 1000 == 999:
            assert len(monitor.open) < 12
            sizes.append(len(monitor.snapshot()))
    assert sizes[0] < sizes[9]
    assert max(sizes[15:]) <= 1.01 * max(sizes[:15])


@pytest.mark.slow
@pytest.mark.parametrize("time", ["", "time sampled\n", "time sampled every 1 s\n"])
def test_a_reason_says_when_the_key_last_occurred(time):
    """A reason never says "never" or "since" about an event that did occur then."""
    spec, claims = rvmon.loads(text_of(REQUIRED["another event with the key"], time)), Counter()
    for seed in range(100):
        rng, t, done = random.Random(seed), 0, []
        monitor = spec.monitor()
        for _ in range(rng.randint(3, 25)):
            t += rng.choice([1, 1, 2, 4, 9])
            values = {"order": {"id": rng.randrange(4)}} if rng.random() < 0.5 else {}
            if rng.random() < 0.4:
                values["done"] = {"id": rng.randrange(4)}
                done.append((t, values["done"]["id"]))
            monitor.step(t, values)
        report = monitor.finish(t + 20)
        start = report.origin // 10**9  # reasons count from there
        for one in report.attempts:
            before = [
                at - start
                for at, key in done
                if key == one.captured["k"] and at * 10**9 < one.decided
            ]
            claim = re.search(r"(never been true|since|last been true at) ?([0-9.]*)", one.reason)
            if one.verdict != "F":
                continue
            words, instant = claim.groups()
            claims[words] += 1
            if words == "never been true":
                assert not before, one.reason
            elif words == "since":
                assert all(at <= float(instant) for at in before), one.reason
            else:
                assert max(before) == float(instant), one.reason
    assert min(claims[words] for words in ("never been true", "since", "last been true at")) > 5


@pytest.mark.parametrize("many", [2, 7, pytest.param(70, marks=pytest.mark.slow)])
def test_attempts_that_become_certain_together_are_numbered_by_their_triggers(many):
    """The order of their instances does not matter; attempts that start in doubt do the same."""
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
