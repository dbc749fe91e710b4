"""Counts, durations, shares and extremes over the last D: their expansion, and what is refused."""

import re

import pytest
from tests.tools.each import each

import rvmon
from rvmon.language.print import format_formula

HEAD = (
    "spec s\nsignal a : bool\nsignal x : real\nsignal d : real [s]\nevent e(k: int), f\n"
    "requirement R\n  upon f\n  then immediately "
)


def required(text):
    spec = rvmon.loads(f"{HEAD}({text})\n  let v = x\n")
    return format_formula(spec.checked.requirements["R"].consequent)


PRINTED = (
    "max(d, 5 s) <= 6 s",
    "max(x, 5 s) <= x",
    "max(x, 1 s) - min(x, 1 s) <= 2",
    "count(e, 5 s) - count(f, 5 s) <= 2",
    "delta(x, 5 s) <= v",
    "count(e and e.k == 1, 5 s) >= 3",
    "duration(a and x > 1, 90 s) >= 1 ns",
    "count(e and e.k == 1) > v",
    "duration(a) > x * 1 s",
    "mean(x) >= v / 1.2",
    "sum(if a then x else 0, 5 s) > 2",
    "sum(if f and a then e.k else 0, 5 s) > 2",
    "integral(if a and x > 1 then x * x else 0) >= 2 s",
    "variance(last(20, x)) > 0.5",
    "distinct(last(9, e.k)) >= 3",
    "count(last(9, a)) > x",
    "duration((a or x > 1) since trigger) >= 2 s",
    "mean(x since trigger) > v",
)
"""What is printed as it was read."""


@each(
    ("text", "printed"),
    [
        *zip(PRINTED, PRINTED, strict=True),
        ("count(e, 5 s) >= 2.5", "count(e, 5 s) >= 3"),
        ("3 > count(rise(a), 5 s)", "count(rise(a), 5 s) < 3"),
        ("count(e, 5 s) == 2", "count(e, 5 s) >= 2 and count(e, 5 s) <= 2"),
        ("count(e, 5 s) >= 0", "true"),
        ("duration(a, 60 s) <= 4 s", "duration(a, 1 min) <= 4 s"),
        ("share(a, 10 s) >= 70 %", "duration(a, 10 s) >= 7 s"),
        ("max(x, 5 s) <= 1", "historically[0, 5 s] x <= 1"),
        ("max(x, 5 s) >= v", "once[0, 5 s] x >= v"),
        ("min(x, 5 s) != 2", "not ((once[0, 5 s] x <= 2) and historically[0, 5 s] x >= 2)"),
        ("now > 5 s -> a", "(once[5000000001 ns, inf) true) -> a"),
        ("5 s > now", "not once[5 s, inf) true"),
        ("max(x) <= 1", "historically x <= 1"),
        ("ago(x, 5 s) <= v", "once[5 s, 5 s] x <= v"),
        ("share(a, 10 s) >= x", "duration(a, 10 s) >= x * 10 s"),
        ("sum(e.k, 5 s) == 2", "sum(e.k, 5 s) >= 2 and sum(e.k, 5 s) <= 2"),
        ("integral(d, 1 min) < 1 min^2", "integral(d, 1 min) < 3600 s^2"),
        ("max(last(5, x)) <= 2", "count(last(5, x > 2)) < 1"),
        ("min(last(5, x)) <= 2", "count(last(5, x <= 2)) >= 1"),
        ("max(x since trigger) >= 2", "once (now - `upon` >= 0 s and x >= 2)"),
        ("max(e.k, 5 s) <= 2", "not once[0, 5 s] e.k > 2"),
        ("x <= 2 * mean(x, 5 s)", "mean(x, 5 s) >= x / 2"),
        ("abs(x - mean(x, 5 s)) <= 3", "mean(x, 5 s) >= x - 3 and mean(x, 5 s) <= x + 3"),
        ("abs(mean(x, 5 s)) >= v", "not (mean(x, 5 s) < v and mean(x, 5 s) > -v)"),
        ("3 - share(a, 5 s) / -2 > x", "duration(a, 5 s) > (3 - x) * -2 * 5 s"),
        ("-integral(x) / 4 s < v", "integral(x) > -(v * 4 s)"),
        ("share(a, 5 s) > max(x, 5 s)", "duration(a, 5 s) > max(x, 5 s) * 5 s"),
    ],
)
def test_comparisons_expand_into_a_few_basic_ones(text, printed):
    assert required(text) == printed


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("count(a, 5 s) > 2", "in `time held` `a` holds at every nanosecond of a stretch"),
        ("count(e, 5 s)", "is a number, expected a formula"),
        ("mean(x, 5 s) > mean(x, 9 s)", "`mean(x, D) - mean(y, D)` is `mean(x - y, D)`"),
        ("mean(x, 5 s) * x > 2", "moves between samples along more than one window"),
        ("sqrt(mean(x, 5 s)) > 2", "through more than `+ - * /` and constants"),
        ("max(mean(x, 5 s), 9 s) > 2", "cannot be measured over another one"),
        ("max(x, 5 s) - e.k > 2", "value only while its event occurs"),
        ("now > duration(a, 5 s)", "expected a comparison of `now` with a duration"),
        ("count(e, 5 s) > e.k", "`e.k` has a value only while its event occurs"),
        ("sum(x * x, 5 s) > 2", "`sum` measures a field of an event, or one signal"),
        ("integral(e.k, 5 s) > 2 s", "`integral` measures signals"),
        ("mean(e.k * x, 5 s) > 2", "`mean` measures signals, or fields of an event"),
        ("integral(x, 5 s) > 2", "`2` needs a unit"),
        ("sum(if within 1 s f then e.k else 0) > 2", "refers to the future"),
        ("share(a) > 2 %", "`share` takes two arguments, 1 given"),
        ("ago(e.k, 1 s) > 2", "`ago` measures signals"),
        ("count(e, 0 s) > 1", "`0 s` is not a duration"),
        ("count(within 1 s e, 5 s) > 1", "`within 1 s e` refers to the future"),
        ("count(e, 5 s) > 2 s", "[no unit] compared with [s]"),
        ("duration(a, 5 s) > 2", "`2` is not a duration"),
        ("now", "expected a comparison of `now` with a duration"),
        ("now + 3 s > 4 s", "expected a comparison of `now` with a duration"),
        ("always (a -> within (d) f)", "`(d)` comes from data and is not a constant duration"),
        ("median(x, 5 s) <= 2", "`share(x > 2, 10 s) <= 10 %`"),
        ("average(x, 5 s) <= 2", "write `mean(x, 10 s)`"),
        ("derivative(x) <= 2", "write `rate(x)`"),
        ("variance(x, 5 s) <= 2", "moves along a curve between samples"),
        ("stddev(x, 5 s) <= 2", "its square is the variance"),
        ("rms(x, 5 s) <= 2", "its square is the mean of squares"),
        ("delta(e.k, 5 s) <= 2", "`delta` measures signals"),
        ("distinct(x * x, 5 s) <= 2", "`distinct` measures a field of an event, or one signal"),
        ("last(5, x) <= 2", "`last(5, x)` are several values"),
        ("mean(last(0, x)) <= 2", "`0` is not a whole number from 1 to 1,000,000"),
        ("mean(last(5, x + v)) <= e.k", "`e.k` has a value only while its event occurs"),
        ("mean(last(5, x * d / 1 s)) <= 2", "does not read exactly one signal or event"),
        ("integral(last(5, x)) <= 2 s", "`integral` measures time, not updates"),
        ("share(last(9, a)) > 2 %", "`share` measures time, not updates"),
        ("mean(2, 5 s) <= 2", "`mean` measures signals, or fields of an event"),
        ("mean(last(5, x), 5 s) <= 2", "`mean(last(5, x), 5 s)` has two windows"),
        ("count(e since trigger, 5 s) <= 2", "has two windows"),
    ],
)
def test_refused_amounts(text, message):
    """The message names the alternative."""
    with pytest.raises(rvmon.SpecError, match=re.escape(message)):
        required(text)


def test_a_sum_may_add_chosen_occurrences_only():
    """An event may occur several times at one instant; the condition selects among them."""
    text = (
        "event e(k: int, x: real, ok: bool), f\nrequirement R\n  upon e.k == k then within 3 s "
        "(sum({}, 5 s) <= 2) for each k in e.k\n"
    )
    chosen = "if e.k == k and e.ok then e.x else 0"
    required = rvmon.loads(text.format(chosen)).checked.requirements["R"].consequent
    assert format_formula(required) == f"within 3 s sum({chosen}, 5 s) <= 2"
    with pytest.raises(rvmon.SpecError, match="`for each` may see several"):
        rvmon.loads(text.format("if e.k == k or e.ok then e.x else 0"))


def test_since_the_trigger_needs_a_trigger():
    """A bare formula has no trigger, and a trigger cannot refer to itself."""
    for body in ("always count(e since trigger) <= 2", "upon count(e since trigger) > 2 then f"):
        with pytest.raises(rvmon.SpecError, match="there is none here"):
            rvmon.loads(f"event e, f\nrequirement R\n  {body}\n")


def test_a_past_amount_needs_held_time():
    """In sampled time there are no values between samples."""
    text = "time sampled\nsignal x : real\nrequirement R\n  always ago(x, 5 s) <= 2\n"
    with pytest.raises(rvmon.SpecError, match="there may be no sample"):
        rvmon.loads(text)
