"""Conversions of time refuse values out of range and show the number."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.tools.each import each

import rvmon
from rvmon.errors import TraceError
from rvmon.trace.stamps import stamps_of, ticks_of_stamp
from rvmon.trace.time import (
    TICKS_PER_UNIT,
    TIME_LIMIT,
    ticks_of_seconds,
    ticks_of_text,
    whole_ticks,
)


@each(
    ("read", "time", "shown"),
    [
        (ticks_of_seconds, Fraction(10**10), "time 10000000000 s is"),
        (ticks_of_seconds, -(10**10), "time -10000000000 s is"),
        (ticks_of_seconds, 1e300, r"time 1e\+300 s is"),
        # An integer that Python refuses to print.
        (ticks_of_seconds, 10**5000, r"time beyond 10\*\*30 s is"),
        (whole_ticks, 10**5000, r"time beyond 10\*\*30 ns is"),
    ],
)
def test_what_is_out_of_range_is_shown_as_a_number(read, time, shown):
    with pytest.raises(TraceError, match=f"{shown} out of range"):
        read(time)


@pytest.mark.slow
@settings(deadline=None)
@given(
    st.one_of(
        st.floats(-4.6e9, 4.6e9),
        st.floats(-1e-6, 1e-6),
        # Halves of a tick, and their neighbours.
        st.tuples(st.integers(-(2**42), 2**42), st.sampled_from([-1, 0, 1])).map(
            lambda pair: pair[0] * 2.0**-10 * (1 + pair[1] * 2.0**-52)
        ),
        st.integers(-(2**62) // 10, 2**62 // 10).map(lambda n: (n + 0.5) / 1e9),
    )
)
def test_seconds_are_rounded_once(seconds):
    """A float gives the nearest tick; ties go to the even one."""
    is_coarse = math.ulp(seconds) > 1e-9
    stands_for = Fraction(repr(seconds) if is_coarse else seconds)
    assert ticks_of_seconds(seconds) == round(stands_for * 1_000_000_000)


DOOR = """spec door
signal knock : bool
requirement Told
  upon updated(knock)
  then immediately knock
"""


@pytest.mark.slow
@settings(deadline=None, max_examples=30)
@given(
    st.lists(
        st.tuples(st.integers(0, 3_999_999_999), st.integers(0, 10**9 - 1), st.integers(0, 6)),
        min_size=1,
        unique_by=lambda one: one[0],
    )
)
def test_a_stamp_of_few_digits_is_exact_by_all_doors(stamps):
    texts = [f"{s}.{part // 10 ** (9 - digits):0{digits}d}" for s, part, digits in sorted(stamps)]
    exact = [ticks_of_text(text.rstrip(".")) for text in texts]
    floats = [float(text) for text in texts]
    spec = rvmon.loads(DOOR)
    monitor = spec.monitor()
    stepped = [one.triggered for t in floats for one in monitor.step(t, {"knock": True})]
    assert stepped == exact
    for unit, ticks in (("s", 10**9), ("ms", 10**6), ("us", 10**3)):
        column = np.array([float(Fraction(t, ticks)) for t in exact])
        columns = {"t": column, "knock": np.ones(len(column), bool)}
        report = spec.evaluate(columns, time=f"t:{unit}")
        assert [one.triggered for one in report.attempts] == exact
        named = stamps_of(f"t:{unit}")
        assert [ticks_of_stamp(one, named) for one in column.tolist()] == exact


@pytest.mark.slow
@settings(deadline=None)
@given(
    st.from_regex(
        r"[+-]?(\d{1,32}(\.\d{0,22})?|\.\d{1,22})", fullmatch=True, alphabet="0123456789+-."
    ),
    st.sampled_from(["s", "ms", "us"]),
)
def test_texts_are_rounded_once(text, unit):
    exact = round(Fraction(text) * TICKS_PER_UNIT[unit])
    if abs(exact) < TIME_LIMIT:
        assert ticks_of_text(text, unit) == exact
    else:
        with pytest.raises(TraceError, match="out of range"):
            ticks_of_text(text, unit)


@each("text", ["", ".", "1_0", "1.2.3", "\N{SUPERSCRIPT TWO}", "0x1", "1 2", "nan"])
def test_texts_that_are_not_decimals_are_refused(text):
    """Digits of other scripts are read as by Python; everything else is refused."""
    with pytest.raises(TraceError):
        ticks_of_text(text)
