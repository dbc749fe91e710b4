"""Counts, durations, shares and extremes of the last D: what they stand for, what is refused."""

import re

import pytest

import rvmon
from rvmon.spec.print.printer import format_formula

HEAD = (
    "spec s\nsignal a : bool\nsignal x : real\nsignal d : real [s]\nevent e(k: int), f\n"
    "requirement R\n  upon f\n  then immediately "
)


def owed(text):
    """What is owed, as it is printed."""
    spec = rvmon.loads(f"{HEAD}({text})\n  let v = x\n")
    return format_formula(spec.checked.requirements["R"].consequent)


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("count(e, 5 s) > 2", "count(e, 5 s) >= 3"),
        ("count(e, 5 s) >= 2.5", "count(e, 5 s) >= 3"),
        ("count(e, 5 s) <= 2", "not count(e, 5 s) >= 3"),
        ("3 > count(rise(a), 5 s)", "not count(rise(a), 5 s) >= 3"),
        ("count(e, 5 s) == 2", "count(e, 5 s) >= 2 and not count(e, 5 s) >= 3"),
        ("count(e, 5 s) >= 0", "true"),
        ("duration(a, 60 s) <= 4 s", "not duration(a, 1 min) >= 4000000001 ns"),
        ("share(a, 10 s) >= 70 %", "duration(a, 10 s) >= 7 s"),
        ("share(a, 10 s) < 0.5", "not duration(a, 10 s) >= 5 s"),
        ("max(x, 5 s) <= 1", "historically[0, 5 s] x <= 1"),
        ("max(x, 5 s) >= v", "once[0, 5 s] x >= v"),
        ("2 < min(x, 5 s)", "historically[0, 5 s] x > 2"),
        ("min(x, 5 s) != 2", "not ((once[0, 5 s] x <= 2) and historically[0, 5 s] x >= 2)"),
        ("max(d, 5 s) <= 6 s", "max(d, 5 s) <= 6 s"),
    ],
)
def test_all_comparisons_are_made_of_a_few(text, printed):
    """What grows with what there is; a `max` of times is the greater of two."""
    assert owed(text) == printed


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("count(a, 5 s) > 2", "in `time held` `a` holds at every nanosecond of a stretch"),
        ("count(e, 5 s) > x", "can only be compared with a constant"),
        ("count(e, 5 s)", "can only be compared with a constant"),
        ("count(e, 0 s) > 1", "`0 s` is no duration"),
        ("count(within 1 s e, 5 s) > 1", "`within 1 s e` speaks of the future"),
        ("count(e, 5 s) > 2 s", "[no unit] compared with [s]"),
        ("duration(a, 5 s) > 2", "`2` is no duration"),
        ("max(x, 5 s) <= x", "with a constant, or with a captured value"),
        ("max(x, 5 s) - 1 <= 2", "with a constant, or with a captured value"),
        ("mean(x, 5 s) <= 2", "`share(x > 2, 10 s) <= 10 %`"),
        ("variance(x, 5 s) <= 2", "bound the spread"),
        ("sum(x, 5 s) <= 2", "publish the sum as a signal"),
    ],
)
def test_what_is_refused(text, message):
    """With what says it instead."""
    with pytest.raises(rvmon.SpecError, match=re.escape(message)):
        owed(text)


def test_printed_amounts_are_read_back():
    """What is printed means the same."""
    for text in ("count(e and e.k == 1, 5 s) >= 3", "duration(a and x > 1, 90 s) >= 1 ns"):
        assert owed(text) == text
