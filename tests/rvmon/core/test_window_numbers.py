"""Numbers of past windows: the memory they take, when they are due, and their exact sums."""

import random
from collections import deque
from fractions import Fraction

import pytest
from tests.tools.each import each

import rvmon
from rvmon.language.checked.window_measures import Measured


@pytest.mark.allocator
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
def test_members_take_the_stated_memory(measured, text):
    spec = rvmon.loads(f"signal x : real\nrequirement R\n  always not {text}\n")
    monitor = spec.monitor()
    monitor.step(0.0, {"x": 0.5})
    begun = monitor._core.memory_used()
    for t in range(1, 16_400):  # just above a power of two, where the ring has doubled
        monitor.step(float(t), {"x": float(t)})
    taken = monitor._core.memory_used() - begun
    assert 16 * 16_400 < taken <= measured.each * 16_400 + 6 * 16_384  # with the outgrown rings


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
def test_a_number_that_changes_between_samples_is_due_when_it_crosses_its_limit(required, due):
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


def test_sums_are_exact():
    """The order does not matter, and nothing is left of numbers outside the window."""
    spec = rvmon.loads(
        "spec s\nevent e(x: real)\nrequirement R\n  upon e then immediately "
        "(sum(e.x, 3 s) == 1 or sum(e.x, 3 s) < 0)\n"
    )
    for values in ([1e300, 1.0, -1e300], [1.0, 1e300, -1e300], [1e16, -1e16, 0.1, 0.9]):
        samples = [(float(t), {"e": {"x": x}}) for t, x in enumerate([*values])]
        last = spec.evaluate(samples).attempts[-1]
        assert last.verdict.value == "P" if len(values) == 3 else "F"


def test_means_and_variances_are_the_doubles_nearest_to_exact_ones():
    spec = rvmon.loads(
        "spec s\nsignal x : real\nevent e\nrequirement R\n  upon e then immediately not e\n"
        "  let mean = mean(last(7, x))\n  let spread = variance(last(7, x))\n"
    )
    monitor, rng, last = spec.monitor(), random.Random(1), deque(maxlen=7)
    for t in range(600):
        last.append(Fraction(rng.uniform(-1, 1) * 2.0 ** rng.choice([0, 0, 0, 3, -40, 300, -300])))
        (record,) = monitor.step(float(t), {"x": float(last[-1]), "e": True})
        mean = sum(last) / len(last)
        spread = sum((x - mean) ** 2 for x in last) / len(last)
        assert record.captured == {"mean": float(mean), "spread": float(spread)}, last
