"""Conversions of time refuse what is out of range, in words that show the number."""

from fractions import Fraction

import pytest

from rvmon.errors import TraceError
from rvmon.trace.time import ticks_of_seconds, whole_ticks


@pytest.mark.parametrize(
    ("seconds", "shown"),
    [
        (Fraction(10**10), "time 10000000000 s is"),
        (-(10**10), "time -10000000000 s is"),
        (1e300, r"time 1e\+300 s is"),
    ],
)
def test_seconds_out_of_range_are_shown_as_a_number(seconds, shown):
    """A fraction is shown as a number."""
    with pytest.raises(TraceError, match=shown + " out of range"):
        ticks_of_seconds(seconds)


@pytest.mark.parametrize("read", [ticks_of_seconds, whole_ticks])
def test_very_many_digits_are_refused(read):
    """An integer that Python would not write out is out of range like any other."""
    with pytest.raises(TraceError, match=r"time beyond 10\*\*30 n?s is out of range"):
        read(10**5000)
