"""Durations and intervals in whole ticks, ages, and differences between the time models."""

from tests.tools.each import each

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
def test_refused_durations(codes, text, code):
    assert codes(f"requirement R upon start then {text}") == [code]


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
    """Older than D: no update within the last D, nor did the trace start within it."""
    assert required(text) == required(meaning) == printed


def test_time_models(checked):
    assert checked("").time is checked("time held").time is TimeModel.HELD
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
