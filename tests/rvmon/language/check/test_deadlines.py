"""Deadlines that come from data: their expansion, what is refused, when they are missed."""

import re

import pytest
from tests.tools.each import each

import rvmon
from rvmon.language.print import format_formula

HEAD = (
    "spec s\nsignal a : bool\nsignal d : real [s]\nsignal n : int\nsignal far : real [m]\n"
    "event e(w: real [s]), f, g\nrequirement R\n  upon e then "
)


def loaded(text):
    return rvmon.loads(HEAD + text + "\n")


@each(
    ("text", "printed"),
    [
        ("a until now >= t0 + d let t0 = now", "a until now - t0 >= d"),
        ("a until d + t0 < now let t0 = now", "a until now - t0 > d"),
        ("a until now - t0 >= v let t0 = now let v = d", "a until now - t0 >= v"),
        ("for 3 s (now - t0 <= 2 s -> a) let t0 = now", "for 3 s (not now - t0 > 2 s -> a)"),
        ("always (now >= d -> a)", "always (now >= d -> a)"),
        (
            "within (far / (5 m/s)) f",
            "not now - `upon` > `within` until (f and not now - `upon` > `within`)",
        ),
        ("for (e.w) a", "now - `upon` > `for` R (a or now - `upon` > `for`)"),
    ],
)
def test_deadlines_expand_into_elapsed_time(text, printed):
    found = format_formula(loaded(text).checked.requirements["R"].consequent)
    assert found == printed


@each(
    ("text", "message"),
    [
        ("always (a -> within (d) f)", "comes from data"),
        ("within (n) f", "`(n)` is not a duration"),
        ("a until t0 >= 3 s let t0 = now", "expected a comparison of `now` with a duration"),
        ("a until now == t0 let t0 = now", "expected a comparison of `now` with a duration"),
        ("a until now - t0 >= e.w let t0 = now", "has a value only while its event occurs"),
        ("a until t0 + t0 <= now let t0 = now", "expected a comparison of `now` with a duration"),
    ],
)
def test_refused_deadlines(text, message):
    with pytest.raises(rvmon.SpecError, match=re.escape(message)):
        loaded(text)


@each(
    ("text", "values", "after"),
    [
        ("within (far / (5 m/s)) f", {"far": 10.0}, 2.0),
        ("within (e.w) f", {"e": {"w": 0.3}}, 0.3),
        ("within (v * 2) f let v = d", {"d": 0.25}, 0.5),
        ("(not (now > t0 + d)) until f let t0 = now", {"d": 1.5}, 1.5),
    ],
)
def test_a_deadline_is_missed_one_tick_after_it(text, values, after):
    begin = {"far": 1.0, "d": after, "e": {"w": 7.0}} | values
    last = 5 + round(after * 1e9)
    for tell, expected in (
        (lambda monitor: monitor.step_ns(last, {"f": True}), ("P", last)),
        (lambda monitor: monitor.advance_ns(last + 10), ("F", last + 1)),
    ):
        monitor = loaded(text).monitor()
        monitor.step_ns(5, begin)
        (one,) = tell(monitor)
        assert (one.verdict, one.decided) == expected


@each(
    ("text", "samples", "verdict"),
    [
        # What must hold until the deadline need not hold after it.
        ("for (e.w) a", [(0.0, {"a": True, "e": {"w": 2.0}}), (2.1, {"a": False})], "P"),
        ("for (e.w) a", [(0.0, {"a": True, "e": {"w": 2.0}}), (2.0, {"a": False})], "F"),
        # An unknown deadline leaves the attempt open.
        ("within (e.w) f", [(0.0, {"e": {"w": None}}), (9.0, {})], "I"),
    ],
)
def test_the_instant_of_the_deadline_is_in_time(text, samples, verdict):
    assert loaded(text).evaluate(samples).verdicts["R"] == verdict
