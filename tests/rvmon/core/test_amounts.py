"""Counts, durations, extremes and functions in the core: of practice, and beside the oracle."""

import pytest
from tests.tools.differential import campaign, disagreements
from tests.tools.forms import Compiler, Maker

import rvmon
from rvmon.spec.checked.measured import Measured
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile
from rvmon.testing.law.word import Outage
from rvmon.trace.sample import Sample


def ticks(form):
    """Samples at whole seconds, one a letter."""
    return [(float(t), one) for t, one in enumerate(form)]


def drawn(*sums):
    """What users withdraw at one instant."""
    return {"withdrawn": [{"user": user, "sum": amount} for user, amount in sums]}


BEATS = [{"beat": {"ms": ms}} for ms in (900, 400, 400, 900, 400, 400, 400, 900)]
BEAT = {"beat": True}
STILL = [{"north": 47.0, "east": 8.0}] * 3

CASES = {
    "the glucose of a pump is between two levels for 70 % of the day": (
        "signal g : real",
        "upon end then immediately share(g >= 70 and g <= 180, 10 s) >= 70 %",
        ticks([{"g": 60}, {}, {}, *[{"g": 100}] * 8]),
        ticks([{"g": 60}, {}, {}, {}, *[{"g": 100}] * 7]),
    ),
    "a burner leaks for at most 4 s of any 60 s": (
        "signal leak : bool",
        "always duration(leak, 60 s) <= 4 s",
        [(0.0, {"leak": False}), (10.0, {"leak": True}), (14.0, {"leak": False})],
        [(0.0, {"leak": False}), (10.0, {"leak": True}), (14.1, {"leak": False})],
    ),
    "there are five fixes in each second": (
        "event fix, begun",
        "whenever held(not begun, 1 s) then count(fix, 1 s) >= 5",
        [(n / 5, {"fix": True, "begun": n == 0}) for n in range(20)],
        [(n / 5, {"fix": n != 9 and n != 10, "begun": n == 0}) for n in range(20)],
    ),
    "five failed logins of one user in a minute lock the account": (
        "event failed(user: int), locked(user: int)",
        "upon failed.user == u and count(failed.user == u, 1 min) >= 3 then "
        "within 2 s locked.user == u for each u in failed.user",
        ticks(
            [
                {"failed": {"user": 1}},
                {"failed": {"user": 2}},
                {"failed": {"user": 1}},
                {"failed": {"user": 1}},
                {"locked": {"user": 1}},
                {},
                {},
            ]
        ),
        ticks(
            [
                {"failed": {"user": 1}},
                {"failed": {"user": 2}},
                {"failed": {"user": 1}},
                {"failed": {"user": 1}},
                {"locked": {"user": 2}},
                {},
                {},
            ]
        ),
    ),
    "five fast beats in eight seconds switch the mode": (
        "event beat(ms: int), switched",
        "upon beat and count(beat.ms < 500, 8 s) >= 5 then immediately switched",
        ticks([*BEATS[:6], {**BEATS[6], "switched": True}]),
        ticks(BEATS),
    ),
    "a temperature stays within 3 degrees of what it was over a minute": (
        "signal c : real",
        "always not (max(c, 60 s) > 23 and min(c, 60 s) < 20)",
        [(0.0, {"c": 19}), (30.0, {"c": 21}), (91.0, {"c": 24})],
        [(0.0, {"c": 19}), (30.0, {"c": 21}), (89.0, {"c": 24})],
    ),
    "a drone flies at 2 m/s on the mean of 10 s": (
        "signal v : real [m/s]",
        "always mean(v, 10 s) <= 2 m/s",
        [(0.0, {"v": 1.0}), (9.0, {"v": 3.0}), (14.0, {"v": 1.0}), (30.0, {})],
        [(0.0, {"v": 1.0}), (9.0, {"v": 3.0}), (14.1, {"v": 1.0}), (30.0, {})],
    ),
    "a load is at most 20 % above the mean of an hour": (
        "signal load : real",
        "always mean(load, 1 h) >= load / 1.2",
        ticks([{"load": 10.0}, *[{}] * 9, {"load": 12.0}]),
        ticks([{"load": 10.0}, *[{}] * 9, {"load": 12.5}]),
    ),
    "a flight from take-off on is at most 100 m long": (
        "signal v : real [m/s]\nsignal flying : bool",
        "always integral(if flying then v else 0) <= 100 m",
        ticks([{"v": 9.0, "flying": True}, *[{}] * 9, {"v": 10.0}, {"flying": False}, {}]),
        ticks([{"v": 9.0, "flying": True}, *[{}] * 9, {"v": 10.0}, {}, {"flying": False}]),
    ),
    "a battery gives at most 5 Wh": (
        "signal u : real [V]\nsignal i : real [A]",
        "always integral(u * i) <= 5 Wh",
        [(0.0, {"u": 10.0, "i": 5.0}), (360.0, {"i": 0.0}), (500.0, {})],
        [(0.0, {"u": 10.0, "i": 5.0}), (361.0, {"i": 0.0})],
    ),
    "the last five probes are below 10 on the mean": (
        "signal x : real",
        "always mean(last(5, x)) < 10",
        ticks([{"x": x} for x in (30.0, 0.0, 0.0, 0.0, 0.0, 12.0, 20.0)][1:]),
        ticks([{"x": x} for x in (0.0, 0.0, 8.0, 12.0, 20.0, 12.0)]),
    ),
    "five of the last eight beats are fast, and the mode is switched": (
        "event beat(ms: int), switched",
        "upon beat and count(last(8, beat.ms < 500)) >= 5 then immediately switched",
        [(t**2 / 3, {**one, "switched": t == 6}) for t, one in enumerate(BEATS[:7])],
        [(t**2 / 3, one) for t, one in enumerate(BEATS)],
    ),
    "most of five probes agree": (
        "signal a : bool",
        "upon end then immediately count(last(5, a)) >= 3",
        ticks([{"a": a} for a in (False, True, True, False, True)]),
        ticks([{"a": a} for a in (True, True, False, False, True, False)]),
    ),
    "no user withdraws more than 500 in 31 days": (
        "event withdrawn(user: int, sum: int)",
        "upon withdrawn.user == u then immediately sum(withdrawn.sum, 744 h) <= 500 "
        "for each u in withdrawn.user",
        [(0.0, drawn((1, 300), (2, 300))), (86400.0 * 30, drawn((1, 100), (1, 100)))],
        [(0.0, drawn((1, 300), (2, 300))), (86400.0 * 30, drawn((1, 100), (1, 101)))],
    ),
    "a user reaches at most two hosts in an hour": (
        "event login(user: int, host: int)",
        "upon login.user == u then immediately distinct(login.host, 1 h) <= 2 "
        "for each u in login.user",
        [
            (t * 1900.0, {"login": {"user": u, "host": h}})
            for t, (u, h) in enumerate([(1, 7), (2, 9), (1, 8), (1, 7), (1, 6), (1, 6)])
        ],
        [
            (t * 1100.0, {"login": {"user": u, "host": h}})
            for t, (u, h) in enumerate([(1, 7), (2, 9), (1, 8), (1, 6)])
        ],
    ),
    "a burst has as many beats before its last as its head said": (
        "event head(beats: int), beat, last",
        "upon head then (not last) until (last and count(beat since trigger) >= n) "
        "let n = head.beats",
        ticks(
            [{"beat": True}, {"head": {"beats": 2}}, {"beat": True}, {"beat": True, "last": True}]
        ),
        ticks([BEAT, {"head": {"beats": 2}}, BEAT, {"last": True}]),
    ),
    "a drone hovers: its position spreads little over the last four fixes": (
        "signal z : real [m]",
        "always variance(last(4, z)) <= 0.25 m^2",
        ticks([{"z": z} for z in (0.0, 1.0, 0.0, 1.0, 0.5)]),
        ticks([{"z": z} for z in (0.0, 1.0, 0.0, 1.0, 1.5)]),
    ),
    "a tank changes by at most 3 l in a minute": (
        "signal level : real [L]",
        "always (delta(level, 1 min) <= 3 L and delta(level, 1 min) >= -3 L)",
        [(0.0, {"level": 5.0}), (30.0, {"level": 8.0}), (91.0, {"level": 9.0})],
        [(0.0, {"level": 5.0}), (30.0, {"level": 8.0}), (59.0, {"level": 9.0})],
    ),
    "a door that was asked for opens in the time that it says, and stays so": (
        "event asked(wait: real [s], stay: real [s]), opened\nsignal closed : bool",
        "upon asked then (within (asked.wait) opened) and (for (asked.stay) not closed)",
        [
            (0.0, {"asked": {"wait": 2.0, "stay": 3.0}, "closed": False}),
            (2.0, {"opened": True}),
            (3.5, {"closed": True}),
        ],
        [
            (0.0, {"asked": {"wait": 2.0, "stay": 3.0}, "closed": False}),
            (2.0, {"opened": True}),
            (3.0, {"closed": True}),
        ],
    ),
    "at most 500 are withdrawn in 31 days": (
        "event withdrawn(sum: int)",
        "always sum(withdrawn.sum, 744 h) <= 500",
        [(t * 86400.0, {"withdrawn": {"sum": s}}) for t, s in ((0, 300), (20, 200), (32, 200))],
        [(t * 86400.0, {"withdrawn": {"sum": s}}) for t, s in ((0, 300), (20, 200), (31, 1))],
    ),
    "as many beats come before the last as the head said": (
        "event head(beats: int), beat, last",
        "upon head then (not last) until (last and count(beat, 1 h) >= n) let n = head.beats",
        ticks([{"head": {"beats": 2}}, {"beat": True}, {"beat": True}, {"last": True}]),
        ticks([{"head": {"beats": 3}}, {"beat": True}, {"beat": True}, {"last": True}]),
    ),
    "a value is no more than 2 off from what it was a minute ago": (
        "signal x : real\nevent asked",
        "upon asked then immediately (ago(x, 60 s) >= v - 2 and ago(x, 60 s) <= v + 2) let v = x",
        [(0.0, {"x": 1.0}), (50.0, {"x": 4.0}), (109.0, {"asked": True, "x": 3.0})],
        [(0.0, {"x": 1.0}), (50.0, {"x": 4.0}), (110.0, {"asked": True, "x": 1.0})],
    ),
    "the rotation of a frame is that of its angle": (
        "signal yaw : real [deg]\nsignal m : real",
        "always abs(m - cos(yaw)) <= 1e-6",
        ticks([{"yaw": 60.0, "m": 0.5}]),
        ticks([{"yaw": 60.0, "m": 0.6}]),
    ),
    "a drone stays near where it took off": (
        "signal north, east : real [deg]",
        "always distance_on_earth(north, east, 47 deg, 8 deg) <= 200 m",
        ticks([*STILL, {"north": 47.0017, "east": 8.0}]),
        ticks([*STILL, {"north": 47.0019, "east": 8.0}]),
    ),
    "the level of two sources of noise is at most 85 dB": (
        "signal p, q : real",
        "always 10 * log10(pow(10, p / 10) + pow(10, q / 10)) <= 85",
        ticks([{"p": 80.0, "q": 81.0}]),
        ticks([{"p": 84.0, "q": 81.0}]),
    ),
    "a status word says that nothing is armed": (
        "signal status : int",
        "always (not bit(status, 7) and bit_and(status, 3) != 3)",
        ticks([{"status": 0b01100010}]),
        ticks([{"status": 0b11100010}]),
    ),
    "a robot turns by at most 30 degrees from one pose to the next": (
        "signal yaw : real [deg]",
        "always abs(angle_between(prev(yaw), yaw)) <= 30 deg",
        ticks([{"yaw": 340.0}, {"yaw": 5.0}, {"yaw": 350.0}]),
        ticks([{"yaw": 340.0}, {"yaw": 15.0}]),
    ),
}


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
"""Beside what passes and what fails of it in the third second."""


@pytest.mark.parametrize("time", TimeModel)
@pytest.mark.parametrize("text", EXPRESSIONS)
def test_windows_are_numbers_in_every_expression(text, time):
    """What a user types first, in each time model."""
    if time is not TimeModel.HELD and "ago" in text:
        pytest.skip("there may be no sample at that instant")
    every = " 500 ms" if time is TimeModel.CLOCKED else ""
    spec = rvmon.loads(f"spec s\ntime {time}{every}\n{HEIGHTS}\nrequirement R\n  always {text}\n")
    before = [(0.0, {"x": 0.0, "y": 1.0, "a": False, "b": False}), (1.0, {"a": True, "b": False})]
    found = []
    for last in EXPRESSIONS[text]:
        b = {"b": last.get("b", "a" in last and text.startswith("count(a, 5 s) -"))}
        found.append(spec.evaluate([*before, (3.0, {**last, **b}), (5.0, {})]).verdicts["R"].value)
    assert found == ["P", "F"]


def test_numbers_of_windows_are_captured():
    """At the trigger, and of an event beside its own window."""
    spec = rvmon.loads(
        "signal x : real\nevent e(k: int)\nrequirement R\n  upon e\n"
        "  then for 5 s x <= m + d let m = max(x, 5 s) let d = e.k - count(e, 5 s)\n"
    )
    samples = [(0.0, {"x": 3.0}), (1.0, {"x": 1.0}), (2.0, {"e": {"k": 2}}), (4.0, {"x": 4.0})]
    assert spec.evaluate(samples, until=9.0).verdicts["R"] == "P"
    samples[2] = (2.0, {"e": {"k": 1}})
    assert spec.evaluate(samples, until=9.0).verdicts["R"] == "F"


def test_a_lost_number_leaves_an_expression_unknown_till_it_has_left():
    """Alone a window keeps what it may be; among others it is unknown."""
    spec = rvmon.loads("signal x : real\nrequirement R\n  always max(x, 3 s) - min(x, 3 s) <= 2\n")
    monitor = spec.monitor()
    for t, x in ((0.0, 0.0), (1.0, None), (2.0, 0.0), (6.0, 3.0)):
        monitor.step(t, {"x": x})
    (failed,) = (one for one in monitor.finish(9.0).attempts if one.verdict == "F")
    assert failed.decided == 6_000_000_000


@pytest.mark.parametrize(
    ("required", "due"),
    [("max(x, 3 s) <= x", [0, 4_000_000_000]), ("x + 2 <= ago(x, 3 s)", [3_000_000_000])],
)
def test_an_expression_is_due_where_a_window_jumps(required, due):
    """Though nothing comes."""
    spec = rvmon.loads(f"signal x : real\nrequirement R\n  upon {required}\n  then false\n")
    report = spec.evaluate([(0.0, {"x": 5.0}), (1.0, {"x": 3.0})], until=20.0)
    assert [one.triggered for one in report.attempts] == due


@pytest.mark.law
@pytest.mark.parametrize("time", TimeModel)
def test_expressions_of_windows_are_those_of_the_oracle(time):
    """With outages, put away and taken up again, step by step and by rows."""
    seeds = [f"expressions/{time.name}/{number}" for number in range(40)]
    profile, traces = Profile(time=time, amounts=100, form="expression"), TraceProfile(outages=40)
    compiler = Compiler()
    makers = {form: Maker(form, compiler) for form in ("c+interrupt", "c rows")}
    found = campaign(makers, seeds, profile, traces, each=4, online_every=4)
    assert not found.disagreements, found.disagreements[0]
    assert [found.counts[f"judged by {form}"] for form in makers] == [160, 160]


@pytest.mark.parametrize("name", CASES)
def test_requirements_of_practice(name):
    """Each passes on one recording and fails on one that is a little off."""
    head, body, good, bad = CASES[name]
    spec = rvmon.loads(f"spec s\n{head}\nrequirement R\n  {body}\n")
    assert [spec.evaluate(trace).verdicts["R"].value for trace in (good, bad)] == ["P", "F"]


@pytest.mark.law
@pytest.mark.parametrize("time", TimeModel)
def test_amounts_are_those_of_the_oracle(time):
    """With losses and outages, step by step and by rows."""
    seeds = [f"amounts/{time.name}/{number}" for number in range(60)]
    profile, traces = Profile(time=time, amounts=100), TraceProfile(outages=20)
    compiler = Compiler()
    makers = {form: Maker(form, compiler) for form in ("c", "c rows")}
    found = campaign(makers, seeds, profile, traces, each=4, online_every=4)
    assert not found.disagreements, found.disagreements[0]
    assert [found.counts[f"judged by {form}"] for form in makers] == [240, 240]


NEVER = {
    "duration(false, 2 ns) >= 1 ns": "I",
    "count(false, 2 ns) >= 1": "I",
    "sum(if e.k > 1 and false then e.k else 0, 2 ns) > 0": "F",
}


@pytest.mark.parametrize(("amount", "verdict"), NEVER.items())
def test_what_is_never_true_where_a_sample_may_have_been(amount, verdict):
    """Every formula is unknown there, constants too; but it makes no number a member."""
    text = f"time sampled\nevent e(k: int)\nrequirement R\n  upon e then {amount}\n"
    spec = rvmon.loads(text).checked
    lost = Outage(frozenset(), 1, 1)
    case = Case(spec, (Sample(2, {"e": {"k": 2}}),), None, outages=(lost,))
    assert disagreements(case, Maker("c")) == []
    monitor = rvmon.Spec(spec).monitor()
    monitor.lose_ns([], 1)
    monitor.found_ns([], 1)
    monitor.step_ns(2, {"e": {"k": 2}})
    assert monitor.finish().verdicts["R"] == verdict


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
    """At most, when each is another number."""
    spec = rvmon.loads(f"signal x : real\nrequirement R\n  always not {text}\n")
    monitor = spec.monitor()
    monitor.step(0.0, {"x": 0.5})
    begun = monitor._core.memory_used()
    for t in range(1, 16_400):  # one ring was just made twice as large
        monitor.step(float(t), {"x": float(t)})
    taken = monitor._core.memory_used() - begun
    assert 16 * 16_400 < taken <= measured.each * 16_400 + 6 * 16_384  # and rings before these


def test_an_amount_is_due_between_samples():
    """The tick at which a duration crosses its bound is a deadline."""
    spec = rvmon.loads(
        "spec s\nsignal a : bool\nrequirement R\n  always duration(a, 10 s) <= 4 s\n"
    )
    monitor = spec.monitor()
    monitor.step(0.0, {"a": True})
    assert monitor.next_due == 4_000_000_001
    (failed,) = monitor.advance(5.0)
    assert failed.decided == 4_000_000_001


@pytest.mark.parametrize(
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
    """Worked out ahead, to the tick."""
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


def test_a_sum_goes_on_from_a_snapshot():
    """At every sample, as if nothing had been."""
    required = (
        "mean(x, 3 s) <= 2",
        "integral(x) <= 7 s",
        "distinct(x, 3 s) <= 1",
        "delta(x, 3 s) <= 1",
    )
    required += ("variance(last(2, x)) <= 1", "sum(last(2, x)) <= 3", "count(last(3, x > 2)) <= 1")
    body = "".join(f"requirement R{n}\n  always {one}\n" for n, one in enumerate(required))
    spec = rvmon.loads(f"spec s\nsignal x : real\n{body}")
    samples = [(0.0, {"x": 1.0}), (1.0, {"x": None}), (2.5, {"x": 2.5}), (4.0, {"x": 1e300})]
    whole = spec.monitor()
    other = spec.monitor()
    for t, sample in samples:
        assert whole.step(t, sample) == other.step(t, sample)
        other = spec.restore(other.snapshot())
    assert whole.finish(9.0).verdicts == other.finish(9.0).verdicts


def test_a_condition_that_is_lost_bounds_a_sum():
    """What may have been added lies between 0 and all of it."""
    spec = rvmon.loads(
        "spec s\nsignal a : bool\nevent e(x: real)\nrequirement R\n"
        "  always sum(if a then e.x else 0, 10 s) <= 5\n"
    )
    for last, verdict in ((2.0, "P"), (3.0, "I"), (6.0, "F")):
        monitor = spec.monitor()
        monitor.step(0.0, {"a": True, "e": {"x": last}})
        monitor.step(1.0, {"a": None, "e": {"x": 3.0}})
        assert monitor.finish(2.0).verdicts["R"].value == verdict


@pytest.mark.parametrize("window", ["", ", 5 s"])
def test_a_lost_condition_alone_may_trigger(window):
    """Time makes enough of what may be a member since the loss: no trigger is missed."""
    spec = rvmon.loads(
        "signal r : bool\nsignal x : real\nrequirement R\n"
        f"  upon integral(if r then x else 0{window}) >= 2 s\n  then false\n"
    )
    monitor = spec.monitor()
    monitor.step(0.0, {"x": 1.0, "r": False})
    monitor.lose(["r"], 23.0)
    report = monitor.finish(40.0)
    assert report.verdicts["R"] == "I"
    assert [one.triggered for one in report.attempts] == [25 * 10**9]


def test_another_instant_of_the_trigger_may_be_captured_at_the_next_tick():
    """Though nothing comes: what hangs on `now` in doubt is known no longer."""
    spec = rvmon.loads(
        "spec s\nsignal p : bool\nrequirement R\n  upon p then immediately now <= t0\n"
        "  let t0 = now\n"
    )
    monitor = spec.monitor()
    for t, p in ((1.0, False), (3.0, None), (7.0, False)):
        monitor.step(t, {"p": p})
    assert monitor.finish().verdicts["R"].value == "I"


def test_a_limit_that_is_lost_hides_no_attempt():
    """Each edge has one, whatever is known of what it owes."""
    spec = rvmon.loads(
        "spec s\nsignal q : bool\nsignal y : int\nevent h(m: real)\nrequirement R\n"
        "  upon q then immediately mean(h.m, 3 ns) > y\n"
    )
    monitor = spec.monitor()
    for t, sample in ((5, {"q": True}), (14, {"y": 0}), (17, {"q": False})):
        monitor.step_ns(t, sample)
    monitor.lose_ns(["y"], 23)
    monitor.found_ns(["y"], 23)
    monitor.step_ns(23, {"q": True})
    assert [one.triggered for one in monitor.finish().attempts] == [5, 23]


def test_a_loss_leaves_open_what_it_may_have_held():
    """An amount is known where what was lost does not matter."""
    spec = rvmon.loads("spec s\nevent e\nrequirement R\n  always count(e, 10 s) < 3\n")
    monitor = spec.monitor()
    monitor.step(0.0, {"e": True})
    monitor.step(1.0, {"e": None})
    monitor.step(2.0, {"e": True})
    assert monitor.finish(20.0).verdicts["R"].value == "I"
    monitor = spec.monitor()
    monitor.step(0.0, {"e": True})
    monitor.step(1.0, {"e": None})
    assert monitor.finish(20.0).verdicts["R"].value == "P"
