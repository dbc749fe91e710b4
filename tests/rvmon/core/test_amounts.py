"""Requirements from practice on counts, durations, means and other numbers of windows."""

from tests.tools.build import actions
from tests.tools.each import each

import rvmon

NAMES = """
signal p : bool
signal x : real
signal y : real [V]
signal z : real [A]
event e
event f
event g(k: int, m: int)
event asked(wait: real [s], stay: real [s])
"""
CASES = {
    "the glucose of a pump is between two levels for 70 % of the day": (
        "upon end then immediately share(x >= 70 and x <= 180, 10 s) >= 70 %",
        *("0 x=60; 3 x=100; 10", "0 x=60; 4 x=100; 10"),
    ),
    "a burner leaks for at most 4 s in any 60 s": (
        *("always duration(p, 60 s) <= 4 s", "0 -p; 10 p; 14 -p", "0 -p; 10 p; 15 -p"),
    ),
    "each 5 s contain five position fixes": (
        "whenever held(not f, 5 s) then count(e, 5 s) >= 5",
        "; ".join(f"{t} e{' f' * (not t)}" for t in range(20)),
        "; ".join(f"{t}{' e' * (t not in (9, 10))}{' f' * (not t)}" for t in range(20)),
    ),
    "a drone flies at a mean of at most 2 over 10 s": (
        *("always mean(x, 10 s) <= 2", "0 x=1; 9 x=3; 14 x=1; 30", "0 x=1; 9 x=3; 15 x=1; 30"),
    ),
    "a flight is at most 100 m long": (
        "always integral(if p then x else 0) <= 100 s",
        *("0 x=9 p; 10 x=10; 11 -p; 12", "0 x=9 p; 10 x=10; 12 -p"),
    ),
    "a battery delivers at most 5 Wh": (
        "always integral(y * z) <= 5 Wh",
        *("0 y=10 z=5; 360 z=0; 500", "0 y=10 z=5; 361 z=0"),
    ),
    "the mean of the last five probes is below 10": (
        "always mean(last(5, x)) < 10",
        "0 x=0; 1 x=0; 2 x=0; 3 x=0; 4 x=12; 5 x=20",
        "0 x=0; 1 x=0; 2 x=8; 3 x=12; 4 x=20; 5 x=12",
    ),
    "the mode switches when five of the last eight beats are fast": (
        "upon g and count(last(8, g.k < 500)) >= 5 then immediately f",
        "0 g=900; 1 g=400; 2 g=400; 5 g=900; 8 g=400; 9 g=400; 12 g=400 f",
        "0 g=900; 1 g=400; 2 g=400; 5 g=900; 8 g=400; 9 g=400; 12 g=400; 16 g=900",
    ),
    "no user withdraws more than 500 in 31 days": (
        "upon g.k == u then immediately sum(g.m, 744 h) <= 500 for each u in g.k",
        "0 g=1/300,2/300; 2592000 g=1/100,1/100",
        "0 g=1/300,2/300; 2592000 g=1/100,1/101",
    ),
    "a user reaches at most two hosts in an hour": (
        "upon g.k == u then immediately distinct(g.m, 1 h) <= 2 for each u in g.k",
        "0 g=1/7; 1900 g=2/9; 3800 g=1/8; 5700 g=1/7; 7600 g=1/6; 9500 g=1/6",
        "0 g=1/7; 1100 g=2/9; 2200 g=1/8; 3300 g=1/6",
    ),
    "a burst has as many beats as its head announced": (
        "upon g then (not f) until (f and count(e since trigger) >= n) let n = g.k",
        *("0 e; 1 g=2; 2 e; 3 e f", "0 e; 1 g=2; 2 e; 3 f"),
    ),
    "the position of a hovering drone varies little over the last four fixes": (
        "always variance(last(4, x)) <= 0.25",
        "0 x=0; 1 x=1; 2 x=0; 3 x=1; 4 x=0.5",
        "0 x=0; 1 x=1; 2 x=0; 3 x=1; 4 x=1.5",
    ),
    "a tank changes by at most 3 in a minute": (
        "always (delta(x, 1 min) <= 3 and delta(x, 1 min) >= -3)",
        *("0 x=5; 30 x=8; 91 x=9", "0 x=5; 30 x=8; 59 x=9"),
    ),
    "a requested door opens within the stated time and stays open": (
        "upon asked then (within (asked.wait) e) and (for (asked.stay) not p)",
        *("0 asked -p; 2 e; 4 p", "0 asked -p; 2 e; 3 p"),
    ),
    "a value differs by at most 2 from that of a minute ago": (
        "upon e then immediately (ago(x, 60 s) >= v - 2 and ago(x, 60 s) <= v + 2) let v = x",
        *("0 x=1; 50 x=4; 109 e x=3", "0 x=1; 50 x=4; 110 e x=1"),
    ),
}
"""Requirement, a recording that passes, and a slightly different one that fails; in seconds."""


@each("name", CASES)
def test_a_requirement_passes_and_just_fails(name):
    required, *recordings = CASES[name]
    spec = rvmon.loads(f"spec s\n{NAMES}\nrequirement R\n  {required}\n")
    verdicts = []
    for recording in recordings:
        told = [(one.t, dict(one.values)) for one in actions(recording)]
        if "asked" in told[0][1]:
            told[0][1]["asked"] = {"wait": 2.0, "stay": 3.0}
        verdicts.append(spec.evaluate(told).verdicts["R"])
    assert verdicts == ["P", "F"]
