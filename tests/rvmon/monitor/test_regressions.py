"""Cases in which a monitor once differed from the semantics, shrunk by the differential test."""

import random

import pytest
from tests.tools.build import actions
from tests.tools.differential import disagreements
from tests.tools.forms import FORMS, Compiler, Maker

import rvmon
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample

CASES = {
    "a window that is to hold up to the left operand and with it is not met before it is over": (
        *("held", "upon start then e R (for 0 s true)", "0 e", 0),
    ),
    "a window fails where the left operand holds": (
        *("sampled", "upon start then e R (within 2 ns p)", "0 e -p; 5", 5),
    ),
    "a signal is not born by NaN": (
        *("sampled", "whenever q then F[3 ns, 6 ns] ((z >= y) U[0 ns, 3 ns] p)"),
        *("0 p q y=nan z=1; 6 p -q y=nan z=0; 10 p -q y=1 z=0", 10),
    ),
    "a row met younger later leads on younger": (
        *("held", "upon start then (always p) R (e R[3 ns, 5 ns] true)", "0", 5),
    ),
    "a signal that nothing reads grows stale between two ticks": (
        *("sampled every 3 ns", "upon e then true", "8; 13 unread=1; 16 e", 16),
    ),
    "a value grows stale between two ticks that was as good as unknown": (
        *("sampled every 3 ns", "upon e then 1 / x < 2", "8; 13 x=0; 16 e", 16),
    ),
    "a constant below an operator of the past is no cause of anything": (
        *("held", "upon start then once[1 ns, 1 ns] (F[0 ns, 0 ns] false)", "0", 0),
    ),
    "what is asked at the end was known before": (
        *("held", "upon end then once[0 ns, 0 ns] (F true)", "0", 1),
    ),
    "an attempt begins where what was open before is settled": (
        *("sampled every 1 ns", "upon e then G[1 ns, 1 ns] p", "0 e; 4 e; 5 p", 6),
    ),
    "a loop without a boundary ahead, before the instant 0": (
        *("held", "whenever true then F[1 ns, 1 ns] true", "-3; 11 unread=1", 11),
    ),
    "what is never for good is open at the end": (
        *("held", "upon start then eventually always p", "0 p; 1 -p", None),
    ),
    "what comes again and again is open at the end": (
        *("sampled every 3 ns", "upon e then always eventually (p until q)", "0 -p q e; 6 -q"),
        None,
    ),
    "an occurrence whose key is not known says nothing in an instance": (
        *("held", "upon g then within 3 ns (g.m > 1) for each v in g.k", "0 g=1/1; 2 g=/0", 9),
    ),
    "an instance begins after its trigger was known, and is not now": (
        *("held", "upon p then within 3 ns q for each v in g.k", "0 -p -q; 3 ?p; 5 g=1; 7 p", 12),
    ),
    "an instance begins between two ticks of the clock": (
        *("sampled every 3 ns", "upon g then start for each v in g.k", "1; 10 g=1,0", 12),
    ),
    "what was met at the near end of a window need not have been led up to there": (
        *("held", "upon e then q since[2 ns, 3 ns] (F[0 ns, 1 ns] p)", "0 p -q; 1 -p q; 2 e; 5", 9),
    ),
    "samples are farther apart than the shorter of two windows is long": (
        *("sampled", "upon e then immediately once[1 ns, 2 ns] p and once[1 ns, 9 ns] q"),
        *("0 p q; 4; 8 e; 9 e; 13 e", 20),
    ),
    "what was met does not count where it is cut, though it is met there again": (
        *("held", "upon e then immediately q since[1 ns, 3 ns] p", "0 -p q; 2 p -q e; 4 e", 9),
    ),
    "a window that has not opened does not count as held to the end": (
        *("held", "upon e then always[5 ns, inf) p", "0 p e; 3", 3),
    ),
    "an episode goes on where its trigger is unknown, also if that is a pulse": (
        *("held", "whenever e and q then within 3 ns p", "0 -p q e; 1 ?q e; 2 q e; 3", 12),
    ),
    "what has held for less than its duration since the start is not held, ahead neither": (
        *("held", "upon e then held(F[0 ns, 1 ns] p, 3 ns)", "0 p; 2 e; 5", 9),
    ),
    "one update is no change yet": ("held", "whenever true then delta(x) <= 1", "0 x=1; 1 x=1", 1),
    "of two occurrences at a tick one is not known, and a signal is not born": (
        *("sampled every 3 ns", "whenever true then not g.k > x", "0; 1 ?g; 2 g=1/1; 4 x=5", 9),
    ),
    "one deadline after the other passes without a sample": (
        *("sampled", "upon e then within 3 ns p", "0 -p e; 2 e; 4!; 6!; 8!", 20),
    ),
    "in sampled time an advance into a window is no position; the sample after it is one": (
        *("sampled", "upon p then always [5 ns, 9 ns] q", "0 p -q; 4 r; 7!; 8 -r; 12", 20),
    ),
    "a value comes again after it was stale, in samples that hold all names": (
        *("held", "upon e then within 2 ns x == -1"),
        *("4 x=-2 -e; 11 x=-2 e; 12 x=-2 -e; 13 x=-2 -e; 14 x=-2 -e; 18 x=-2 -e", None),
    ),
    "time that passes without a sample hides no further attempt": (
        *("held", "whenever true then F[3 ns, 3 ns] G r", "-3 -r; 5!; 7", None),
    ),
    "in a silence each failure is followed by the next attempt, though an older one waits": (
        *("held", "always (p -> (r and F[1 ns, 20 ns] q) or F[1 ns, 3 ns] q)"),
        *("0 p -q r; 1 -p; 2 p -r; 15", None),
    ),
    "a gap is told when the first window that lies in it closes": (
        *("held", "whenever p then F[2 ns, 5 ns] q", "0 p q; 10 -q; 20 q", None),
    ),
    "an instance fails under another letter before its next trigger": (
        "sampled every 4 ns",
        "whenever x > 0 or g.k == key then F[0 ns, 0 ns] false for each key in g.k",
        *("0 x=1; 15 g=0; 24 g=0; 28 g=0", None),
    ),
    "between the ticks of a clock a captured attempt is not looked after": (
        *("sampled every 3 ns", "upon e then g.m >= 1 let v = y"),
        *("0 ?e; 2 g=/?; 7 ?e; 8; 11", None),
    ),
    "a window without a tick is over in time": (
        *("sampled every 10 ns", "upon e then F[1 ns, 5 ns] p", "0 p; 10 e; 16!", None),
    ),
    "what is read twice is born when both can be told": (
        *("held", "always (delta(x) <= 1 and x <= 2)", "0 x=1", 0),
    ),
}

CASES |= {
    f"an age counts from the beginning before the first update, at {first}": (
        *("held", "always age(x) <= 10 ns", f"0 y=1; {first} x=1", None),
    )
    for first in (5, 10, 11)
}

CASES |= {
    f"what an open attempt is said to owe is undecided: {required}": (time, required, told, None)
    for time, required, told in (
        ("sampled every 3 ns", "upon e then G[1 ns, inf) (G[1 ns, 1 ns] p)", "0 p e; 4 q; 6!"),
        ("sampled every 1 ns", "upon e then F[1 ns, inf) (G[1 ns, 2 ns] start)", "0 e; 3; 5; 7!"),
        ("held", "whenever true then within 3 ns e", "0 e; 1; 2; 4!"),
        ("sampled", "whenever p then G[1 ns, 1 ns] e", "0 p e; 4; 20; 22!"),
        ("sampled every 1 ns", "upon q then F[1 ns, 1 ns] H[2 ns, 2 ns] F not q", "0 p e; 1 q; 3!"),
    )
}

CASES |= {
    f"time comes to a tick of the clock and passes it: {steps}": (
        *("sampled every 3 ns", "upon e then next next p", f"0 p e; {steps}", 10),
    )
    for steps in ("3!; 8!", "3!; 6!; 8!", "6!; 8!")
}

ALIKE = {
    "an event that was not known occurs at the next position": (
        *("upon e then p", "0 ?e p; 1 e -p; 2 -e -p; 3 ?e p; 4 e -p"),
    ),
    "an invariant alone goes on after each failure": (
        *("whenever p then q", "0 p q; 1 -q; 2 q; 3 -q; 4 q; 5 -p; 6 p -q"),
    ),
    "what comes when an episode is over takes nothing from the values it captured": (
        *("whenever p then within 6 ns y == v let v = z", "0 p z=1 y=0; 1 -p z=2; 2 ?p; 4 y=1; 5"),
    ),
    "an episode of values not known any more that was over when the trigger was lost": (
        "whenever p then eventually y == v let v = z at end fail",
        "0 p z=1 y=0; 1 ?p z=2; 2 -p; 3 ?p; 4",
    ),
    "an episode with captured values goes on after a failure": (
        *("whenever p then y == v let v = z", "0 p z=1 y=1; 1 y=0; 2 y=1; 3; 4 y=0"),
    ),
    "an episode fails and goes on while an attempt of the one before is open": (
        *("whenever p then q and (F[0 ns, 5 ns] r)", "0 p q -r; 1 -p; 2 p; 3 -q; 4 q; 5"),
    ),
    "an episode of a known trigger that began before what is required was born": (
        *("whenever p then eventually y > 3 at end fail", "0 p; 1 y=0; 2 y=1"),
    ),
    "a window opened between two samples": ("upon start then true U[2 ns, 4 ns] true", "0; 1; 4"),
    "a window opened by advance": ("upon start then always[3 ns, 5 ns] false", "0; 2; 3!; 5"),
    "an instance that is made while another has an occurrence": (
        *("upon g then true for each v in g.k", "-2 g=-2; 0 g=-1"),
    ),
    "two instances before the first tick of the clock": (
        *("upon g.k > -1 then p for each v in g.k", "7 -p; 8 g=1,0"),
    ),
    "an episode that ran before the instance was there": (
        *("whenever p then fall(q) for each v in g.k", "0 p; 1 g=0"),
    ),
    "an occurrence that is over at the end": ("upon end then g.k < v let v = y", "0 g=-1 y=1"),
    "a sample that no tick has shown yet": ("upon end then p let v = y", "0; 3 p"),
    "time that has come to zero, behind the end": ("upon end then F[0 ns, 0 ns] false", "-3; 0!"),
    "values that may be others in an episode that may be over": (
        *("whenever p then F[0 ns, 9 ns] y > v let v = z at end strong", "0 p z=1; 1 ?p"),
    ),
    "values that may be others in an episode that is over": (
        *("whenever p then F[0 ns, 9 ns] y > v let v = z at end strong", "0 p; 1 ?p; 2 -p"),
    ),
    "an event that is unknown to one reading only": (
        *("upon start then (F[0 ns, 2 ns] e) and (G[1 ns, 3 ns] p)", "0 ?e p; 2 ?p; 3 p"),
    ),
}
"""Those that each time model has: the requirement, and what is told."""

CASES |= (
    {
        f"{name}, {time}, to {end}": (time, *case, end)
        for name, case in ALIKE.items()
        for time in ("held", "sampled", "sampled every 4 ns")
        for end in (None, 2, 9)
    }
    | {
        f"the position before, asked for the future: {required}": ("sampled", required, told, 9)
        for required, told in (
            (
                "upon start then (Y F[0 ns, 1 ns] q) or not (Y F[0 ns, 1 ns] p)",
                "0 p -q; 1 -p q; 2 p -q",
            ),
            ("whenever p then Y (F[0 ns, 1 ns] q)", "0 p q; 1; 2"),
        )
    }
    | {
        f"a captured attempt moves with each sample, {time}": (time, required, "0; 1", 2)
        for time, required in (
            ("held", "upon start then G[1 ns, 1 ns] p let v = y"),
            ("sampled", "upon start then next true let v = y"),
        )
    }
)


def disagreeing(cases):
    """Differences between each form and the oracle: verdicts, decision instants, by call."""
    compiler = Compiler()
    return [
        (form, found)
        for case in cases
        for form in (*FORMS, "c+interrupt")
        if (found := disagreements(case, Maker(form, compiler), online=True))
    ]


@pytest.mark.law
@pytest.mark.parametrize("name", CASES)
def test_forms_agree_with_the_law(name):
    time, requirement, told, end = CASES[name]
    spec = rvmon.loads(
        f"spec s\ntime {time}\nsignal p, q, r : bool\nsignal unread : real stale after 1 ns\n"
        f"signal x : real stale after 1 ns\nsignal y, z : real\nevent e\nevent g(k: int, m: int)\n"
        f"requirement R1\n  {requirement}\n"
    )
    ends = (None, 2, 9) if end is None else (end,)
    assert disagreeing(Case(spec.checked, actions(told), one) for one in ends) == []


@pytest.mark.law
@pytest.mark.parametrize("count", [0, 65])
def test_no_source_and_many(count):
    names = [f"p{index}" for index in range(65)]
    spec = rvmon.loads(
        f"spec s\nsignal {', '.join(names)} : bool\n"
        f"requirement R1\n  upon start\n  then within 3 ns ({' and '.join(names)})\n"
    )
    sources = names[:count]
    told = [Sample(t, dict.fromkeys(sources, t == 2)) for t in (0, 2)]
    assert disagreeing([Case(spec.checked, (*told, 8), 9, frozenset(sources))]) == []


@pytest.mark.law
@pytest.mark.parametrize("time", ["held", "sampled", "sampled every 2 ns"])
@pytest.mark.parametrize("sources", ["g", "h", "gh", ""])
def test_two_events_of_which_one_has_no_source(time, sources):
    """A comparison of two events is false while one certainly does not occur, otherwise unknown."""
    spec = rvmon.loads(
        f"spec s\ntime {time}\nevent g(k: int)\nevent h(m: real)\n"
        "requirement R1\n  upon start\n  then for 5 ns not g.k > h.m\n"
        "requirement R2\n  upon start\n  then within 5 ns g.k > h.m\n"
    )
    told = [(0, {}), (2, {"g": {"k": 1}}), (3, {}), (7, {"h": {"m": 0.5}}), (9, {})]
    samples = [
        Sample(t, {name: value for name, value in values.items() if name in sources})
        for t, values in told
    ]
    assert disagreeing([Case(spec.checked, tuple(samples), 12, frozenset(sources))]) == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", [38, 57])
def test_a_network_learns_of_an_until_in_order(seed):
    """Truths of several intervals that become known at once have their stamps, not earlier ones."""
    spec = rvmon.loads(
        "spec s\nsignal x, y : real\nrequirement R1\n"
        "  always (x > 3 -> F[0 ns, 16 ns] G[0 ns, 8 ns] y < 3)\n"
    )
    rng = random.Random(seed)
    told = [Sample(t, {"x": rng.uniform(0, 5), "y": rng.uniform(0, 4)}) for t in range(90)]
    assert not disagreements(Case(spec.checked, tuple(told)), Maker(), online=False)
