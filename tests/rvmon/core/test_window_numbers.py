"""Windows of the past as numbers in expressions: compared, captured, bounded by."""

import pytest
from tests.tools.each import each

import rvmon
from rvmon.language.checked.specification import TimeModel
from rvmon.language.checked.window_measures import Measured

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


@each(("text", "time"), IN_TIME)
def test_windows_are_numbers_in_every_expression(text, time):
    every = " 500 ms" if time is TimeModel.CLOCKED else ""
    spec = rvmon.loads(f"spec s\ntime {time}{every}\n{HEIGHTS}\nrequirement R\n  always {text}\n")
    before = [(0.0, {"x": 0.0, "y": 1.0, "a": False, "b": False}), (1.0, {"a": True, "b": False})]
    found = []
    for last in EXPRESSIONS[text]:
        b = {"b": last.get("b", "a" in last and text.startswith("count(a, 5 s) -"))}
        found.append(spec.evaluate([*before, (3.0, {**last, **b}), (5.0, {})]).verdicts["R"].value)
    assert found == ["P", "F"]


@pytest.mark.slow
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
    spec = rvmon.loads(f"signal x : real\nrequirement R\n  always not {text}\n")
    monitor = spec.monitor()
    monitor.step(0.0, {"x": 0.5})
    begun = monitor._core.memory_used()
    for t in range(1, 16_400):  # one ring was just made twice as large
        monitor.step(float(t), {"x": float(t)})
    taken = monitor._core.memory_used() - begun
    assert 16 * 16_400 < taken <= measured.each * 16_400 + 6 * 16_384  # and rings before these


@each(
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
