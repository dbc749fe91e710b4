"""Percentages that are never falsely 0 or 100."""

from hypothesis import given, settings
from hypothesis import strategies as st

from rvmon.texts import percent, percent_text


@settings(deadline=None)
@given(st.integers(1, 10**9), st.data())
def test_nought_and_hundred_are_exact(whole, data):
    """0 and 100 are only shown for none and all, in numbers and in words."""
    part = data.draw(st.integers(0, whole))
    assert (percent(part, whole) == 0) == (part == 0)
    assert (percent(part, whole) == 100) == (part == whole)
    assert (percent_text(part, whole) == "0 %") == (part == 0)
    assert (percent_text(part, whole) == "100 %") == (part == whole)


@settings(deadline=None)
@given(st.integers(1, 10**6), st.data())
def test_a_percentage_is_close(whole, data):
    """It is never off by more than what keeps it from 0 and 100."""
    part = data.draw(st.integers(0, whole))
    assert abs(percent(part, whole) - 100 * part / whole) <= 0.1


def test_of_nothing_all_is_covered():
    """A state without statements hides no hole."""
    assert percent(0, 0) == 100
    assert percent_text(0, 0) == "100 %"
