"""Counts, durations, extremes and functions in the core: of practice, and beside the oracle."""

from tests.tools.each import each

import rvmon


def ticks(form):
    return [(float(t), one) for t, one in enumerate(form)]


def drawn(*sums):
    """What users withdraw at one instant."""
    return {"withdrawn": [{"user": user, "sum": amount} for user, amount in sums]}


def logged_in(user, host):
    return {"login": {"user": user, "host": host}}


LOGINS = [(1, 7), (2, 9), (1, 8)]
BEATS = [{"beat": {"ms": ms}} for ms in (900, 400, 400, 900, 400, 400, 400, 900)]
BEAT = {"beat": True}
ASKED = [
    (0.0, {"asked": {"wait": 2.0, "stay": 3.0}, "closed": False}),
    (2.0, {"opened": True}),
]

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
    "a drone flies at 2 m/s on the mean of 10 s": (
        "signal v : real [m/s]",
        "always mean(v, 10 s) <= 2 m/s",
        [(0.0, {"v": 1.0}), (9.0, {"v": 3.0}), (14.0, {"v": 1.0}), (30.0, {})],
        [(0.0, {"v": 1.0}), (9.0, {"v": 3.0}), (14.1, {"v": 1.0}), (30.0, {})],
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
        [(t * 1900.0, logged_in(*one)) for t, one in enumerate([*LOGINS, (1, 7), (1, 6), (1, 6)])],
        [(t * 1100.0, logged_in(*one)) for t, one in enumerate([*LOGINS, (1, 6)])],
    ),
    "a burst has as many beats before its last as its head said": (
        "event head(beats: int), beat, last",
        "upon head then (not last) until (last and count(beat since trigger) >= n) "
        "let n = head.beats",
        ticks([BEAT, {"head": {"beats": 2}}, BEAT, {**BEAT, "last": True}]),
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
        [*ASKED, (3.5, {"closed": True})],
        [*ASKED, (3.0, {"closed": True})],
    ),
    "a value is no more than 2 off from what it was a minute ago": (
        "signal x : real\nevent asked",
        "upon asked then immediately (ago(x, 60 s) >= v - 2 and ago(x, 60 s) <= v + 2) let v = x",
        [(0.0, {"x": 1.0}), (50.0, {"x": 4.0}), (109.0, {"asked": True, "x": 3.0})],
        [(0.0, {"x": 1.0}), (50.0, {"x": 4.0}), (110.0, {"asked": True, "x": 1.0})],
    ),
}


@each("name", CASES)
def test_requirements_of_practice(name):
    """Each passes on one recording and fails on one that is a little off."""
    head, body, good, bad = CASES[name]
    spec = rvmon.loads(f"spec s\n{head}\nrequirement R\n  {body}\n")
    assert [spec.evaluate(trace).verdicts["R"].value for trace in (good, bad)] == ["P", "F"]
