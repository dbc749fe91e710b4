"""Durations and intervals in whole ticks, ages, and what depends on the time model."""

from tests.tools.each import each

from rvmon.language.checked.formula import Interval
from rvmon.language.checked.specification import TimeModel


@each(
    ("text", "code"),
    [
        ("within 3 (a)", "RV030"),
        ("within x (a)", "RV030"),
        ("within 3 m (a)", "RV030"),
        ("within (1 s / 3) (a)", "RV031"),
        ("F[3 s, 2 s] a", "RV032"),
        ("F(3 ns, 4 ns) a", "RV032"),
        ("F[-1 s, 1 s] a", "RV032"),
        ("within 1300000 h a", "RV032"),
        ("within (1 s * 1e20) a", "RV032"),
        ("F[1 s, 1 s) a", "RV032"),
        ("a unless[1 s, 2 s] b", "RV033"),
        ("a M[1 s, 2 s] b", "RV033"),
        ("next a", "RV034"),
        ("previous a", "RV034"),
        ("within 1 s a\nsignal z : bool stale after 0 s", "RV032"),
        ("within 1 s a\ntime sampled every 0 s", "RV032"),
    ],
)
def test_what_is_no_time_is_refused(codes, text, code):
    assert codes(f"requirement R upon start then {text}") == [code]


@each(
    ("text", "interval"),
    [
        ("F a", Interval(0, None)),
        ("F <= 3 s a", Interval(0, 3 * 10**9)),
        ("within 1e-3 s a", Interval(0, 1_000_000)),
        ("F[0, 3 us] a", Interval(0, 3000)),
        ("within 1200000 h a", Interval(0, 1_200_000 * 3600 * 10**9)),
        ("F[3 ns, 4 ns) a", Interval(3, 3)),
        ("F(3 ns, inf) a", Interval(4, None)),
        ("F(3 ns, 5 ns) a", Interval(4, 4)),
        ("within (T + 2 * 500 ms) a", Interval(0, 4 * 10**9)),
    ],
)
def test_intervals_in_ticks(checked, text, interval):
    spec = checked(f"const T = 3 s\nrequirement R upon start then {text}")
    assert spec.requirements["R"].consequent.interval == interval


@each(
    ("text", "meaning", "printed"),
    [
        ("age(d) > 200 ms", "not once[0, 200 ms] (updated(d) or start)", "age(d) > 200 ms"),
        ("age(d) >= 200 ms", "not once[0, 199999999 ns] (updated(d) or start)", "age(d) >= 200 ms"),
        ("age(d) < 200 ms", "once[0, 199999999 ns] (updated(d) or start)", "age(d) < 200 ms"),
        ("age(d) >= 0", "true", "true"),
        ("age(d) < 0", "false", "false"),
        ("age(e) > 1 s", "not once[0, 1 s] (updated(e) or start)", "age(e) > 1 s"),
    ],
)
def test_age(required, text, meaning, printed):
    """An age is: neither an update within the last D, nor the beginning of the trace."""
    assert required(text) == required(meaning) == printed


def test_time_models(checked):
    assert checked("").time is TimeModel.HELD
    assert checked("time held").time is TimeModel.HELD
    sampled = checked("time sampled\nrequirement R upon a then next b")
    assert sampled.time is TimeModel.SAMPLED
    clocked = checked("time sampled every 20 ms\nmax delay 50 ms")
    assert (clocked.time, clocked.period, clocked.max_delay) == (
        TimeModel.CLOCKED,
        20_000_000,
        50_000_000,
    )


def test_stale_after(checked):
    spec = checked("const T = 200 ms\nsignal z, w : bool input stale after T")
    assert spec.signals["w"].stale_after == 200_000_000
