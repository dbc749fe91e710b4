"""Windows of the past as numbers in expressions: compared, captured, bounded by."""

import pytest
from tests.tools.differential import disagreements
from tests.tools.forms import Maker

import rvmon
from rvmon.spec.checked.measured import Measured
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.word import Outage
from rvmon.trace.sample import Sample

HEIGHTS = "signal x, y : real [m]\nevent a, b"
EXPRESSIONS = {
    "max(x, 2 s) - min(x, 2 s) <= 0.5 m": ({"x": 0.4}, {"x": 0.6}),
    "count(a, 5 s) - count(b, 5 s) <= 1": ({"a": True}, {"a": True, "b": False}),
    "count(a, 5 s) <= count(b, 10 s) + 1": ({"a": True, "b": True}, {"a": True}),
    "abs(delta(x, 2 s)) <= 50 cm": ({"x": -0.5}, {"x": -0.6}),
    "abs(x - mean(x, 5 s)) <= 3 m": ({"x": 3.0}, {"x": 5.0}),
    "x <= 2 * mean(x, 5 s)": ({"x": 0.0}, {"x": 0.1}),
    "x <= max(y, 2 s) + 0.1 m": ({"x": 1.1}, {"x": 1.2}),
    "abs(ago(x, 1 s) - x) <= 1 m": ({"x": 1.0}, {"x": 1.1}),
    "mean(x - y, 4 s) <= 1 m": ({"x": 2.0}, {"x": 4.0}),
}
"""By expression, the sample at 3 s that it holds of, and one that it fails at."""


IN_TIME = [
    (text, time)
    for text in EXPRESSIONS
    for time in ([TimeModel.HELD] if "ago" in text else TimeModel)
]
"""Of held time alone where there may be no sample at an instant."""


@pytest.mark.parametrize(("text", "time"), IN_TIME)
def test_windows_are_numbers_in_every_expression(text, time):
    """What a user types first, in each time model."""
    every = " 500 ms" if time is TimeModel.CLOCKED else ""
    spec = rvmon.loads(f"spec s\ntime {time}{every}\n{HEIGHTS}\nrequirement R\n  always {text}\n")
    before = [(0.0, {"x": 0.0, "y": 1.0, "a": False, "b": False}), (1.0, {"a": True, "b": False})]
    found = []
    for last in EXPRESSIONS[text]:
        b = {"b": last.get("b", "a" in last and text.startswith("count(a, 5 s) -"))}
        found.append(spec.evaluate([*before, (3.0, {**last, **b}), (5.0, {})]).verdicts["R"].value)
    assert found == ["P", "F"]


def test_numbers_of_windows_are_captured():
    """At the trigger, and of an event beside its own window."""
    spec = rvmon.loads(
        "signal x : real\nevent e(k: int)\nrequirement R\n  upon e\n"
        "  then for 5 s x <= m + d let m = max(x, 5 s) let d = e.k - count(e, 5 s)\n"
    )
    samples = [(0.0, {"x": 3.0}), (1.0, {"x": 1.0}), (2.0, {"e": {"k": 2}}), (4.0, {"x": 4.0})]
    assert spec.evaluate(samples, until=9.0).verdicts["R"] == "P"
    samples[2] = (2.0, {"e": {"k": 1}})
    assert spec.evaluate(samples, until=9.0).verdicts["R"] == "F"


def test_a_lost_number_leaves_an_expression_unknown_till_it_has_left():
    """Alone a window keeps what it may be; among others it is unknown."""
    spec = rvmon.loads("signal x : real\nrequirement R\n  always max(x, 3 s) - min(x, 3 s) <= 2\n")
    samples = [(t, {"x": x}) for t, x in ((0.0, 0.0), (1.0, None), (2.0, 0.0), (6.0, 3.0))]
    attempts = spec.evaluate(samples, until=9.0).attempts
    (failed,) = (one for one in attempts if one.verdict == "F")
    assert failed.decided == 6_000_000_000


@pytest.mark.parametrize(
    ("required", "due"),
    [("max(x, 3 s) <= x", [0, 4_000_000_000]), ("x + 2 <= ago(x, 3 s)", [3_000_000_000])],
)
def test_an_expression_is_due_where_a_window_jumps(required, due):
    """Though nothing comes."""
    spec = rvmon.loads(f"signal x : real\nrequirement R\n  upon {required}\n  then false\n")
    report = spec.evaluate([(0.0, {"x": 5.0}), (1.0, {"x": 3.0})], until=20.0)
    assert [one.triggered for one in report.attempts] == due


NEVER = {
    "duration(false, 2 ns) >= 1 ns": "I",
    "count(false, 2 ns) >= 1": "I",
    "sum(if e.k > 1 and false then e.k else 0, 2 ns) > 0": "F",
}


@pytest.mark.parametrize(("amount", "verdict"), NEVER.items())
def test_what_is_never_true_where_a_sample_may_have_been(amount, verdict):
    """Every formula is unknown there, constants too; but it makes no number a member."""
    text = f"time sampled\nevent e(k: int)\nrequirement R\n  upon e then {amount}\n"
    spec = rvmon.loads(text).checked
    lost = Outage(frozenset(), 1, 1)
    case = Case(spec, (Sample(2, {"e": {"k": 2}}),), None, outages=(lost,))
    assert disagreements(case, Maker("c")) == []
    monitor = rvmon.Spec(spec).monitor()
    monitor.lose_ns([], 1)
    monitor.found_ns([], 1)
    monitor.step_ns(2, {"e": {"k": 2}})
    assert monitor.finish().verdicts["R"] == verdict


@pytest.mark.parametrize(
    ("measured", "text"),
    [
        (Measured.COUNT, "count(last(20000, x > 5)) > 30000"),
        (Measured.SUM, "sum(x, 20000 s) < 0"),
        (Measured.MEAN, "mean(x, 20000 s) < 0"),
        (Measured.INTEGRAL, "integral(x, 20000 s) < 0 s"),
        (Measured.VARIANCE, "variance(last(20000, x)) < 0"),
        (Measured.DELTA, "delta(x, 20000 s) > 30000"),
        (Measured.DISTINCT, "distinct(x, 20000 s) > 30000"),
    ],
)
def test_members_take_the_memory_that_is_stated(measured, text):
    """At most, when each is another number."""
    spec = rvmon.loads(f"signal x : real\nrequirement R\n  always not {text}\n")
    monitor = spec.monitor()
    monitor.step(0.0, {"x": 0.5})
    begun = monitor._core.memory_used()
    for t in range(1, 16_400):  # one ring was just made twice as large
        monitor.step(float(t), {"x": float(t)})
    taken = monitor._core.memory_used() - begun
    assert 16 * 16_400 < taken <= measured.each * 16_400 + 6 * 16_384  # and rings before these


def test_an_amount_is_due_between_samples():
    """The tick at which a duration crosses its bound is a deadline."""
    spec = rvmon.loads(
        "spec s\nsignal a : bool\nrequirement R\n  always duration(a, 10 s) <= 4 s\n"
    )
    monitor = spec.monitor()
    monitor.step(0.0, {"a": True})
    assert monitor.next_due == 4_000_000_001
    (failed,) = monitor.advance(5.0)
    assert failed.decided == 4_000_000_001


@pytest.mark.parametrize(
    ("required", "due"),
    [
        ("mean(x, 10 s) <= 3", 6_000_000_000),
        ("mean(x, 4 s) <= 3", 4_666_666_667),
        ("integral(x) <= 9 s", 3_750_000_001),
        ("integral(x, 4 s) <= 9 s", 3_750_000_001),
        ("duration(x > 2) <= 2 s", 4_000_000_001),
    ],
)
def test_what_moves_between_samples_is_due_when_it_crosses(required, due):
    """Worked out ahead, to the tick."""
    spec = rvmon.loads(f"spec s\nsignal x : real\nrequirement R\n  always {required}\n")
    monitor = spec.monitor()
    monitor.step(0.0, {"x": 1.0})
    monitor.step(2.0, {"x": 4.0})
    found = monitor.next_due
    while found < due:
        assert not monitor.advance(found / 1e9)
        found = monitor.next_due
    assert found == due
    (failed,) = monitor.advance(20.0)
    assert failed.decided == due


def test_sums_are_those_of_the_numbers_that_there_are():
    """No order makes another, and nothing is left of what has gone."""
    spec = rvmon.loads(
        "spec s\nevent e(x: real)\nrequirement R\n  upon e then immediately "
        "(sum(e.x, 3 s) == 1 or sum(e.x, 3 s) < 0)\n"
    )
    for values in ([1e300, 1.0, -1e300], [1.0, 1e300, -1e300], [1e16, -1e16, 0.1, 0.9]):
        samples = [(float(t), {"e": {"x": x}}) for t, x in enumerate([*values])]
        last = spec.evaluate(samples).attempts[-1]
        assert last.verdict.value == "P" if len(values) == 3 else "F"


def test_a_sum_goes_on_from_a_snapshot():
    """At every sample, as if nothing had been."""
    required = (
        *("mean(x, 3 s) <= 2", "integral(x) <= 7 s", "distinct(x, 3 s) <= 1", "delta(x, 3 s) <= 1"),
        *("variance(last(2, x)) <= 1", "sum(last(2, x)) <= 3", "count(last(3, x > 2)) <= 1"),
    )
    body = "".join(f"requirement R{n}\n  always {one}\n" for n, one in enumerate(required))
    spec = rvmon.loads(f"spec s\nsignal x : real\n{body}")
    samples = [(0.0, {"x": 1.0}), (1.0, {"x": None}), (2.5, {"x": 2.5}), (4.0, {"x": 1e300})]
    whole = spec.monitor()
    other = spec.monitor()
    for t, sample in samples:
        assert whole.step(t, sample) == other.step(t, sample)
        other = spec.restore(other.snapshot())
    assert whole.finish(9.0).verdicts == other.finish(9.0).verdicts


def test_a_condition_that_is_lost_bounds_a_sum():
    """What may have been added lies between 0 and all of it."""
    spec = rvmon.loads(
        "spec s\nsignal a : bool\nevent e(x: real)\nrequirement R\n"
        "  always sum(if a then e.x else 0, 10 s) <= 5\n"
    )
    for last, verdict in ((2.0, "P"), (3.0, "I"), (6.0, "F")):
        samples = [(0.0, {"a": True, "e": {"x": last}}), (1.0, {"a": None, "e": {"x": 3.0}})]
        assert spec.evaluate(samples, until=2.0).verdicts["R"] == verdict


@pytest.mark.parametrize("window", ["", ", 5 s"])
def test_a_lost_condition_alone_may_trigger(window):
    """Time makes enough of what may be a member since the loss: no trigger is missed."""
    spec = rvmon.loads(
        "signal r : bool\nsignal x : real\nrequirement R\n"
        f"  upon integral(if r then x else 0{window}) >= 2 s\n  then false\n"
    )
    monitor = spec.monitor()
    monitor.step(0.0, {"x": 1.0, "r": False})
    monitor.lose(["r"], 23.0)
    report = monitor.finish(40.0)
    assert report.verdicts["R"] == "I"
    assert [one.triggered for one in report.attempts] == [25 * 10**9]


def test_another_instant_of_the_trigger_may_be_captured_at_the_next_tick():
    """Though nothing comes: what hangs on `now` in doubt is known no longer."""
    spec = rvmon.loads(
        "spec s\nsignal p : bool\nrequirement R\n  upon p then immediately now <= t0\n"
        "  let t0 = now\n"
    )
    samples = [(t, {"p": p}) for t, p in ((1.0, False), (3.0, None), (7.0, False))]
    assert spec.evaluate(samples).verdicts["R"] == "I"


def test_a_limit_that_is_lost_hides_no_attempt():
    """Each edge has one, whatever is known of what it owes."""
    spec = rvmon.loads(
        "spec s\nsignal q : bool\nsignal y : int\nevent h(m: real)\nrequirement R\n"
        "  upon q then immediately mean(h.m, 3 ns) > y\n"
    )
    monitor = spec.monitor()
    for t, sample in ((5, {"q": True}), (14, {"y": 0}), (17, {"q": False})):
        monitor.step_ns(t, sample)
    monitor.lose_ns(["y"], 23)
    monitor.found_ns(["y"], 23)
    monitor.step_ns(23, {"q": True})
    assert [one.triggered for one in monitor.finish().attempts] == [5, 23]


def test_a_loss_leaves_open_what_it_may_have_held():
    """An amount is known where what was lost does not matter."""
    spec = rvmon.loads("spec s\nevent e\nrequirement R\n  always count(e, 10 s) < 3\n")
    samples = [(0.0, {"e": True}), (1.0, {"e": None}), (2.0, {"e": True})]
    assert spec.evaluate(samples, until=20.0).verdicts["R"] == "I"
    assert spec.evaluate(samples[:2], until=20.0).verdicts["R"] == "P"
