"""Cases that random ones seldom hit: each reaches a line of the core that few others reach."""

from collections.abc import Callable
from functools import lru_cache

import pytest
from tests.tools.build import actions
from tests.tools.differential import disagreements
from tests.tools.forms import FORMS, Compiler, Maker

import rvmon
from rvmon.language.checked.specification import CheckedSpec
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.word import Outage

NAMES = """signal p, q : bool
signal x : real
event e
event g(k: int)
event h(m: real)
"""


Make = Callable[[], Case]


@lru_cache(1)
def checked(text: str) -> CheckedSpec:
    """The checked specification, shared by successive cases with the same text."""
    return rvmon.loads(text).checked


def case_of(
    time: str,
    required: str,
    told: str,
    end: int | None = None,
    lost: tuple[tuple[str, int, int], ...] = (),
    names: str | None = None,
) -> Make:
    """A case of one requirement or several, made when it is judged.

    Args:
        time: the time model.
        required: the body of the requirement.
        told: the trace, as `actions` reads it.
        end: end of the trace, if known.
        lost: outages: names of one letter each, in one word; first and last instant.
        names: names that have a source, in one word; `None`: all.
    """
    text = f"time {time}\n{NAMES}requirement R\n  {required}\n"
    outages = tuple(Outage(frozenset(own), first, last) for own, first, last in lost)
    sources = None if names is None else frozenset(names)
    return lambda: Case(checked(text), actions(told), end, sources, outages)


CASES = {
    "a window after 0 of what can hold nowhere": case_of(
        "held", "whenever true then e xor (true R[1 ns, 1 ns] false)", "0 e; 5; 9 e"
    ),
    "two readings with clocks of different ages in one location": case_of(
        *("held", "upon e then G[0 ns, 20 ns] (p -> F[0 ns, 3 ns] q)"),
        *("0 e -p -q; 1 ?p; 2 -p; 3 p; 4 -p; 5 q; 6 -q", 30),
    ),
    "an unknown occurrence is compared with a signal without a value": case_of(
        "sampled", "upon g.k > x then false", "0 ?g; 1; 2 x=1"
    ),
    "an unknown field is compared with a signal without a value": case_of(
        "sampled", "upon g.k > x then false", "0 g=?; 1; 2 x=1"
    ),
    "a network fails again and again during a silence": case_of(
        *("held", "whenever p then F[1 ns, 2 ns] G[0 ns, 1 ns] H[0 ns, 3 ns] q"),
        *("0 p -q; 40!; 50 q", 60),
    ),
    "nested windows are decided by a sample before 0": case_of(
        "held", "upon start then F[1 ns, 1 ns] F[1 ns, 1 ns] p", "-3 p; -1; 6"
    ),
    "a captured value of an episode whose trigger was unknown": case_of(
        *("held", "whenever p then F[0 ns, 4 ns] x > v let v = x"),
        *("0 p x=1; 2 ?p x=2; 3 -p; 6 p; 8 x=3; 9 -p", 20),
    ),
    "nested windows are open at the end of an episode": case_of(
        *("held", "whenever q then G[0 ns, 5 ns] F[1 ns, 7 ns] p", "0 -q; 9 p ?q; 11 -q; 12!; 18 q")
    ),
    "nested windows are open at the end of an episode, with a clock": case_of(
        *("sampled every 2 ns", "whenever q then F[0 ns, 3 ns] F[2 ns, 5 ns] p"),
        *("1 -p; 3 q; 6 p", 11),
    ),
    "an episode ends at a sample, and its windows are known later": case_of(
        "sampled", "whenever q then F[0 ns, 9 ns] G[0 ns, 3 ns] p", "1 p q; 2; 11 -q; 16; 28"
    ),
    "an invariant of nested windows runs to a known end": case_of(
        "held", "always G[0 ns, 0 ns] F[0 ns, 3 ns] p", "1 -p; 5 p", 8
    ),
}

CASES |= {
    f"instances are made again in another order, {time}, trigger {known or 'known'}": case_of(
        *(time, "upon g and p then F[2 ns, 4 ns] q for each key in g.k"),
        *(f"0 -p -q g=1; 6 g=2; 12 g=3; 24 {known}p g=3,2,1; 36 ?p q", 40),
    )
    for known, time in (("", "held"), ("?", "held"), ("?", "sampled every 2 ns"))
}

CASES |= {
    f"an episode with a captured value is in doubt and undecided, at end: {policy}": case_of(
        *("held", f"whenever p then F[0 ns, 40 ns] (q and x > v)\n  at end: {policy}\n  let v = x"),
        *("0 p -q x=1; 2 ?p x=2; 3 p", 9),
    )
    for policy in ("strong", "weak", "pass", "fail", "strict")
}

CASES |= {
    f"a constant future below the past, so that no second attempt follows, {time}": case_of(
        time, "whenever true then p U[0 ns, 0 ns] fall(F[0 ns, 0 ns] true)", "0 p; 6; 9"
    )
    for time in ("held", "sampled", "sampled every 2 ns")
}

CASES["an episode with a value that may be over at the last sample"] = case_of(
    *("sampled", "whenever e then F[2 ns, inf) q\n  let v = x\n  at end: strong"),
    *("0 e -q x=3; 4 e x=1; 8 e x=2; 12 ?e", 15),
)

CASES |= {
    f"what was captured is in doubt: {name}": case_of(time, f"{required} let v = {value}", told)
    for name, time, required, value, told in (
        (
            "the trigger is what is required",
            "sampled",
            "whenever e then always e",
            "x",
            "-3 e; 0 ?e",
        ),
        ("nothing can fail", "held", "whenever e then always[2 ns, inf) true", "g.k", "0 ?e; 1"),
        *(
            (name, "sampled", f"whenever (q or g.k == i) then {owed} for each i in g.k", "x", told)
            for name, owed in (
                ("it fails where it begins", "start"),
                ("it looks back where it begins", "previous false"),
            )
            for told in ("0 q; 1 ?q; 3 g=1",)
        ),
        (
            *("the end fails what has not ended", "held"),
            *("whenever (once e) or g then true at end strong for each i in g.k", "x"),
            "0 g=?; 1 g=6 e",
        ),
        (
            *("a key that is not known", "held", "whenever true then true for each i in g.k"),
            *("g.k", "0; 1 g=?"),
        ),
    )
}

CASES |= {
    f"an instance that begins between ticks stands as at the last one: {required}, {told}": case_of(
        "sampled every 3 ns", f"{required} for each key in g.k", told
    )
    for required, told in (
        # The trigger at the last tick does not see what came after that tick.
        ("upon p or g.k == key then true", "0; 2 ?g; 3 g=1"),
        ("upon p or g.k == key then true", "0 g=?; 1; 3 g=1"),
        # The same where the trigger is an edge only because its past never holds.
        ("upon (once[1 ns, 1 ns] true) or g.k == key then true", "0 ?g; 2; 3 g=0"),
        ("upon (once[1 ns, 1 ns] true) or g.k == key then true", "0; 1 g; 2 g=1; 9"),
        # What came since the last tick did not occur at that tick.
        ("upon g then key >= h.m", "0; 4 h=/0; 5 g=0; 7"),
    )
}

CASES |= {
    f"an instance, {time}: {required}, {told}": case_of(time, required, told)
    for time, required, told in (
        # The numbers 1 and 1.0 are the same key.
        ("held", "upon e then eventually h.m == key for each key in g.k", "0 e g=1; 1; 2 h=/1"),
        ("held", "upon e then eventually g.k == key for each key in h.m", "0 e h=/1; 1; 2 g=1"),
        # The trigger comes first, then the value of `for each`, both before a tick of the clock.
        ("sampled every 3 ns", "upon e then true for each key in g.k", "10 e; 11 g=-2; 15"),
        # Of attempts that become certain together the earlier one has the lower number.
        (
            *("sampled", "whenever p or g.k == n then F[1 ns, 1 ns] true for each n in g.k"),
            "0 -p; 1 g=-1; 16 g=1; 27 ?p g=-1; 32 p",
        ),
        # It looks back to the first position of the run, before any attempt started.
        ("sampled", "upon g then (previous (next true)) for each n in g.k", "0; 1 g=0"),
        # Without a value of `x` the trigger is unknown, and nothing else triggers.
        ("sampled every 2 ns", "upon x != n then true for each n in g.k", "0 x=0; 3 g=0"),
    )
}

CASES |= {
    f"an instance looks back at a name without a source, {time}, {told}": case_of(
        *(time, "upon p and g then once[0 s, 10 ns] (within 10 ns p) for each k in g.k"),
        *(told, None, (), "g"),
    )
    for time in ("held", "sampled", "sampled every 10 ns")
    for told in ("10 g=7", "0; 10 g=7")
}

CASES |= {
    f"a name without a source may have triggered, {time}: {trigger}": case_of(
        *(time, f"upon {trigger} then not p", "0 p; 1 p", None, (), "p")
    )
    for time in ("held", "sampled")
    for trigger in ("p and q", "p and not q", "not p and q", "q since[1 ns, inf) p")
}

CASES["a captured window over an operand that never holds"] = case_of(
    "sampled every 3 ns",
    "upon start then immediately 1 <= v\n"
    "  let v = 1 + integral(if once[2 ns, 2 ns] p then max(x, x) else 0, 3 ns) / 1 s",
    "0 p x=3",
)

CASES |= {
    f"lost of `{lost[0][0]}`, {time}: {required}": case_of(time, required, told, end, lost)
    for time, required, told, end, lost in (
        # A lost event may have had any key; the known one at the same instant has one key.
        (
            *("sampled every 2 ns", "upon g then within 6 ns updated(g) for each k in g.k"),
            *("3; 15 g=1", 16, (("g", 9, 15),)),
        ),
        # All formulas are unknown in an outage, even constants; but no member comes of that.
        *(
            ("sampled", f"upon g then {amount}", "2 g=2", None, (("", 1, 1),))
            for amount in (
                *("duration(false, 2 ns) >= 1 ns", "count(false, 2 ns) >= 1"),
                "sum(if g.k > 1 and false then g.k else 0, 2 ns) > 0",
            )
        ),
        # Nor does a known signal count at a position that may not exist.
        *(
            ("sampled", f"always {amount} <= 2", "0 x=3; 4 x=1", 8, (("q", 1, 1),))
            for amount in ("sum(x, 9 ns)", "integral(x, 9 ns) / 1 ns")
        ),
        # What may have been a member since the outage reaches the limit by time alone.
        *(
            (
                *("held", f"upon integral(if p then x else 0{window}) >= 2 ns then false"),
                *("0 x=1 -p", 40, (("p", 23, 40),)),
            )
            for window in ("", ", 5 ns")
        ),
        # Each edge starts an attempt, whatever is known of its consequent.
        (
            *("held", "upon q then mean(h.m, 3 ns) > x"),
            *("5 q; 14 x=0; 17 -q; 23 q", 23, (("x", 23, 23),)),
        ),
    )
}

CASES |= {
    f"a number of a window: {required}, {told}": case_of("held", required, told, 20)
    for required, told in (
        ("always max(x, 3 ns) - min(x, 3 ns) <= 2", "0 x=0; 1 ?x; 2 x=0; 6 x=3"),
        ("upon max(x, 3 ns) <= x then false", "0 x=5; 1 x=3"),
        ("upon x + 2 <= ago(x, 3 ns) then false", "0 x=5; 1 x=3"),
        ("always count(e, 10 ns) < 3", "0 e; 1 ?e; 2 e"),
        # An unknown value may be one more distinct number, for good.
        ("always distinct(x) <= 2", "0 x=1; 1 ?x; 2 x=2"),
        *(
            ("always sum(if p then h.m else 0, 10 ns) <= 5", f"0 p h=/{m}; 1 ?p h=/3")
            for m in (2, 3, 6)
        ),
        # A comparison with a doubtful `now` is unknown again at the next tick.
        ("upon p then immediately now <= t0 let t0 = now", "1 -p; 3 ?p; 7 -p"),
    )
}

CASES["a variance follows a curve during a silence"] = case_of(
    "sampled every 2 ns", "always variance(x, 9 ns) <= 0.5", "0 x=3; 4 x=1; 20", 45
)

CASES |= {
    f"a window of the past holds nothing from before the trace, {time}": case_of(
        time, "upon start then historically[0 ns, 5 ns] once F[0 ns, 3 ns] q", "0 -q; 1; 2 q"
    )
    for time in ("held", "sampled", "sampled every 2 ns")
}

BESIDE = "\nrequirement Q upon e then true"

MANY = {
    "windows open or close after the last call but before the end": [
        case_of(time, f"upon start then {required}", f"0 p -q; 3; {until}!", end)
        for time in ("held", "sampled", "sampled every 2 ns")
        for required in ("G[5 ns, inf) p", "F[0 ns, 5 ns] q", "(G[5 ns, inf) p) or F[2 ns, 4 ns] q")
        for until in (3, 9)
        for end in (None, 6, 12)
    ],
    "at the end, values are captured at the last tick, not after it": [
        case_of(
            *("sampled every 4 ns", f"upon end then {required}"),
            *(f"-2 x=1 g=1; 1 p g=2; {between}4 x=2 g=1; 6 g=3; 7 ?x -p g=4", end),
        )
        for required in (
            "x > v or p let v = x",
            "true let v = prev(x)",
            "true let v = g.k",
            "x >= v and historically g.k < v let v = x",
            "x >= v for each key in g.k let v = x",
            "once (x == v and g.k == key) for each key in g.k let v = x",
        )
        for between in ("", "2!; ", "4!; ")
        for end in (7, 11)
    ],
    "an episode fails during a silence while an older one is open": [
        case_of(
            *(time, f"whenever p then {required} and F[3 ns, {last} ns] q{BESIDE}"),
            *(f"0 p q x=0; 2 -p; 4 p; 6 -q; {told}32", 45),
        )
        for time in ("held", "sampled every 2 ns")
        for required in ("(F[0 ns, 13 ns] x > 1)", "(F[0 ns, 18 ns] G[0 ns, 2 ns] x > 1)")
        for last in (4, 5)
        for told in ("", "12!; ", "20!; ")
    ],
    "nested windows over several propositions, as `false until q` leaves them": [
        case_of(
            *(time, f"{mode} then F[0 ns, 6 ns] G[1 ns, 4 ns] {base}"),
            *("0 p -q e; 2 q e; 5 ?p; 8 p; 9 -p ?q e; 20 q", 32),
        )
        for time in ("held", "sampled every 2 ns")
        for mode in ("upon e", "whenever q")
        for base in ("(p and (false until q))", "(p or (false until q))")
    ],
}


def round_case(time: str, required: str, gap: int) -> Make:
    """A case in which an attempt is always open, and values change within its windows.

    Without an open attempt the rings of nested windows are cleared, and never wrap around.
    """
    told = "; ".join(
        f"{t} {'' if t % gap else '-'}p{' e' * (t % 5 == 0)}" for t in range(0, 72, 1 + (gap > 2))
    )
    return case_of(time, required, told, 90)


MANY["the rings of nested windows drop what is over, and wrap around"] = [
    round_case(time, required, gap)
    for time in ("held", "sampled", "sampled every 2 ns")
    for required, gap in (
        ("upon e then F[0 ns, 14 ns] G[0 ns, 2 ns] p", 2),
        ("upon e then G[0 ns, 14 ns] F[0 ns, 5 ns] p", 3),
        ("whenever e then G[0 ns, 12 ns] F[0 ns, 4 ns] p\n  at end: strict", 3),
    )
]

MANY["attempts start at adjacent and at distant ticks, by known and unknown triggers"] = [
    case_of(
        *(time, f"upon {trigger} then {required}"),
        "0 -p e g=1 x=1; 1 e; 2 g=1 p; 5 e ?p x=1; 6 ?e; 7 e g=?; 9 -p; 10 e g=1 x=2; 13 p e; 17!; "
        "20 e -p; 21 ?e ?g; 22 e g=1; 23 x=3; 30 e p g=1 x=1",
        40,
        lost=(("e", 12, 14), ("g", 31, 33)),
    )
    for time in ("held", "sampled every 2 ns", "sampled every 5 ns")
    for trigger in ("e", "g.k == 1", "changed(x)", "updated(x)", "e and p", "e or updated(x)")
    for required in (
        "F[1 ns, 4 ns] p",
        "G[0 ns, 3 ns] p",
        "F[0 ns, 6 ns] G[1 ns, 2 ns] p",
        "F[1 ns, 3 ns] once[0 ns, 1 ns] e",
    )
]


@pytest.mark.law
@pytest.mark.parametrize("name", CASES)
def test_a_rare_case_agrees_with_the_law(name: str) -> None:
    case, compiler = CASES[name](), Compiler()
    for form in FORMS:
        assert disagreements(case, Maker(form, compiler), online=True) == [], form


@pytest.mark.law
@pytest.mark.parametrize("name", MANY)
def test_many_cases_of_a_kind_agree_with_the_law(name: str) -> None:
    maker = Maker("c")
    for make in MANY[name]:
        assert disagreements(make(), maker, online=True) == []
