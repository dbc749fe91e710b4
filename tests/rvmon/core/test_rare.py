"""Cases that random ones seldom meet: each needs a line of the core that little else does."""

import random

import pytest
from tests.tools.differential import disagreements
from tests.tools.forms import Maker

import rvmon
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample

NAMES = """signal p, q : bool
signal x : real
event e
event g(k: int)
"""


def case_of(time: str, required: str, *actions: object, end: int | None = None) -> Case:
    """A case of one requirement; actions are pairs of an instant and values, or instants."""
    spec = rvmon.loads(f"time {time}\n{NAMES}requirement R\n  {required}\n").checked
    told = (Sample(*action) if isinstance(action, tuple) else action for action in actions)
    return Case(spec, tuple(told), end)


ENDS = [
    case_of(
        time, f"upon start then {required}", (0, {"p": True, "q": False}), (3, {}), until, end=end
    )
    for time in ("held", "sampled", "sampled every 2 ns")
    for required in ("G[5 ns, inf) p", "F[0 ns, 5 ns] q", "(G[5 ns, inf) p) or F[2 ns, 4 ns] q")
    for until in (3, 5, 9)
    for end in (None, 4, 6, 12)
]

CASES = {
    "what can hold nowhere, were its window open at once": case_of(
        "held",
        "whenever true then e xor (true R[1 ns, 1 ns] false)",
        (0, {"e": True}),
        (5, {}),
        (9, {"e": True}),
    ),
    "two readings with clocks of different ages in one location": case_of(
        "held",
        "upon e then G[0 ns, 20 ns] (p -> F[0 ns, 3 ns] q)",
        (0, {"e": True, "p": False, "q": False}),
        (1, {"p": None}),
        (2, {"p": False}),
        (3, {"p": True}),
        (4, {"p": False}),
        (5, {"q": True}),
        (6, {"q": False}),
        end=30,
    ),
    "an occurrence that is unknown, beside a signal without a value": case_of(
        "sampled", "upon g.k > x then false", (0, {"g": None}), (1, {}), (2, {"x": 1.0})
    ),
    "and one of which the field alone is": case_of(
        "sampled", "upon g.k > x then false", (0, {"g": {"k": None}}), (1, {}), (2, {"x": 1.0})
    ),
    "a requirement of a network that fails again and again while nothing is said": case_of(
        "held",
        "whenever p then F[1 ns, 2 ns] G[0 ns, 1 ns] H[0 ns, 3 ns] q",
        (0, {"p": True, "q": False}),
        40,
        (50, {"q": True}),
        end=60,
    ),
    "windows within windows, decided by a sample before 0": case_of(
        "held",
        "upon start then F[1 ns, 1 ns] F[1 ns, 1 ns] p",
        (-3, {"p": True}),
        (-1, {}),
        (6, {}),
    ),
    "a captured value of an episode whose trigger was unknown": case_of(
        "held",
        "whenever p then F[0 ns, 4 ns] x > v\n  let v = x",
        (0, {"p": True, "x": 1.0}),
        (2, {"p": None, "x": 2.0}),
        (3, {"p": False}),
        (6, {"p": True}),
        (8, {"x": 3.0}),
        (9, {"p": False}),
        end=20,
    ),
}

CASES |= {
    "windows that are open at the end of what is kept up": case_of(
        "held",
        "whenever q then G[0 ns, 5 ns] F[1 ns, 7 ns] p",
        (0, {"q": False}),
        (9, {"p": True, "q": None}),
        (11, {"q": False}),
        12,
        (18, {"q": True}),
    ),
    "the same by a clock": case_of(
        "sampled every 2 ns",
        "whenever q then F[0 ns, 3 ns] F[2 ns, 5 ns] p",
        (1, {"p": False}),
        (3, {"q": True}),
        (6, {"p": True}),
        end=11,
    ),
    "what is kept up to a sample, which says when all of it is known": case_of(
        "sampled",
        "whenever q then F[0 ns, 9 ns] G[0 ns, 3 ns] p",
        (1, {"p": True, "q": True}),
        (2, {}),
        (11, {"q": False}),
        (16, {}),
        (28, {}),
    ),
    "what is always kept up, to an end that is known": case_of(
        "held",
        "always G[0 ns, 0 ns] F[0 ns, 3 ns] p",
        (1, {"p": False}),
        (5, {"p": True}),
        end=8,
    ),
}

CASES |= {
    f"instances made anew in another order, {time}, their trigger: {known}": case_of(
        time,
        "upon g and p\n  then F[2 ns, 4 ns] q\n  for each key in g.k",
        (0, {"p": False, "q": False, "g": {"k": 1}}),
        (6, {"g": {"k": 2}}),
        (12, {"g": {"k": 3}}),
        (24, {"p": known, "g": ({"k": 3}, {"k": 2}, {"k": 1})}),
        (36, {"p": None, "q": True}),
        end=40,
    )
    for known, time in ((True, "held"), (None, "held"), (None, "sampled every 2 ns"))
}

CASES |= {
    f"an episode with a value, clouded and undecided, at end: {policy}": case_of(
        "held",
        f"whenever p then F[0 ns, 40 ns] (q and x > v)\n  at end: {policy}\n  let v = x",
        (0, {"p": True, "q": False, "x": 1.0}),
        (2, {"p": None, "x": 2.0}),
        (3, {"p": True}),
        end=9,
    )
    for policy in ("strong", "weak", "pass", "fail", "strict")
}


LAST_TICKS = [
    case_of(
        "sampled every 4 ns",
        f"upon end\n  then {required}",
        (-2, {"x": 1.0, "g": {"k": 1}}),
        (1, {"p": True, "g": {"k": 2}}),
        *between,
        (4, {"x": 2.0, "g": {"k": 1}}),
        (6, {"g": {"k": 3}}),
        (7, {"x": None, "p": False, "g": {"k": 4}}),
        end=end,
    )
    for required in (
        "x > v or p\n  let v = x",
        "true\n  let v = prev(x)",
        "true\n  let v = g.k",
        "x >= v and historically g.k < v\n  let v = x",
        "x >= v\n  for each key in g.k\n  let v = x",
        "once (x == v and g.k == key)\n  for each key in g.k\n  let v = x",
    )
    for between in ((), (2,), (3,), (4,))
    for end in (7, 8, 11, 14)
]


@pytest.mark.law
def test_what_is_captured_at_the_end_is_what_the_last_tick_saw() -> None:
    """Not what came behind it, be it values, payloads, updates, or instances."""
    make = Maker("c")
    assert [text for case in LAST_TICKS for text in disagreements(case, make, online=True)] == []


RESTARTS = [
    case_of(
        time,
        f"whenever p then {required} and F[3 ns, {last} ns] q\nrequirement Q\n  upon e then true",
        (0, {"p": True, "q": True, "x": 0.0}),
        (2, {"p": False}),
        (4, {"p": True}),
        (6, {"q": False}),
        *told,
        (32, {}),
        end=45,
    )
    for time in ("held", "sampled every 2 ns")
    for required in ("(F[0 ns, 13 ns] x > 1)", "(F[0 ns, 18 ns] G[0 ns, 2 ns] x > 1)")
    for last in (4, 5)
    for told in ((), (12,), (20,))
]


@pytest.mark.law
def test_an_episode_goes_on_at_once_while_an_older_one_is_open() -> None:
    """It fails while nothing is said, and again behind that, before the older one is decided."""
    make = Maker("c")
    assert [text for case in RESTARTS for text in disagreements(case, make, online=True)] == []


def long_case(time: str, required: str, seed: int, many: int) -> Case:
    """A case of many samples in which values change often, and now and then stay for long."""
    rng = random.Random(seed)
    actions: list[object] = []
    t = 0
    for _ in range(many):
        values = {name: rng.random() < 0.5 for name in "pq" if rng.random() < 0.7}
        actions.append((t, {**values, "e": True} if rng.random() < 0.4 else values))
        t += rng.choice((1, 1, 1, 2, 3, 9))
    return case_of(time, required, *actions, end=t)


CHAINS = [
    long_case(time, required, seed, 60)
    for seed, time in enumerate(("held", "sampled", "sampled every 2 ns"))
    for required in (
        "upon e then F[0 ns, 4 ns] G[0 ns, 3 ns] p",
        "whenever q then G[0 ns, 5 ns] F[0 ns, 3 ns] p",
        "whenever q then F[0 ns, 40 ns] G[0 ns, 2 ns] p\n  at end: strict",
        "always F[0 ns, 6 ns] F[0 ns, 3 ns] (p and q)",
    )
]


@pytest.mark.law
def test_windows_within_windows_are_judged_over_many_changes() -> None:
    """What is over is dropped from the rings in which changes stand, which go round."""
    make = Maker("c")
    assert [text for case in CHAINS for text in disagreements(case, make, online=True)] == []


BASES = [
    case_of(
        time,
        f"{mode} then F[0 ns, 6 ns] G[1 ns, 4 ns] {base}",
        (0, {"p": True, "q": False, "e": True}),
        (2, {"q": True, "e": True}),
        (5, {"p": None}),
        (8, {"p": True}),
        (9, {"p": False, "q": None, "e": True}),
        (20, {"q": True}),
        end=32,
    )
    for time in ("held", "sampled every 2 ns")
    for mode in ("upon e", "whenever q")
    for base in ("(p and (false until q))", "(p or (false until q))")
]


@pytest.mark.law
def test_windows_over_several_propositions_are_judged_as_the_law_has_it() -> None:
    """As an `until` of nothing leaves them, which is no formula of the present as it is written."""
    make = Maker("c")
    assert [text for case in BASES for text in disagreements(case, make, online=True)] == []


@pytest.mark.law
@pytest.mark.parametrize("form", ["c", "c rows"])
@pytest.mark.parametrize("name", CASES)
def test_a_rare_case_is_judged_as_the_law_has_it(name: str, form: str) -> None:
    """By each call, and in the report."""
    assert disagreements(CASES[name], Maker(form), online=True) == []


@pytest.mark.law
def test_the_end_is_told_from_how_far_time_came() -> None:
    """A window may open, or be over, behind the last position."""
    make = Maker("c")
    assert [text for case in ENDS for text in disagreements(case, make, online=True)] == []
