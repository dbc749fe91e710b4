"""Windows within windows and `until`, which compiled C judges by letters beside Python."""

import random
import tracemalloc

import pytest
from tests.tools.chains import random_chain
from tests.tools.prepared import Run, compiled_beside, differences

import rvmon
from rvmon.monitor.compiled.specification import compile_spec
from rvmon.testing.generate.trace import TraceProfile, random_trace

pytestmark = pytest.mark.compiler


@pytest.mark.parametrize("seed", range(3))
def test_both_say_the_same_of_windows_and_until(seed):
    """Also what stood at a decision that is found only as the next sample comes."""
    rng, taken = random.Random(f"until {seed}"), 0
    while not taken:
        spec = random_chain(rng, untils=True)
        [one] = compile_spec(spec).chosen(None)
        pair = compiled_beside(spec) if one.engine("auto") == "network" else None
        if pair is not None:
            traces = TraceProfile(samples=60, span=240, unknowns=seed == 0, long=20)
            cases = [random_trace(rng, spec, traces) for _ in range(6)]
            found = [differences(pair, case, f"{seed}/{n}") for n, case in enumerate(cases)]
            assert [told for told, _ in found] == [[]] * len(found)
            taken = sum(taken for _, taken in found)


AT_ONCE = """
spec s
signal p, q, r : bool
requirement R
  whenever p then within 2 s for 5 s (q or r)
"""


def test_a_decision_shows_what_was_read_then():
    """Though it is found as the next sample comes, which changes what is read."""
    pair = compiled_beside(rvmon.loads(AT_ONCE).checked)
    assert pair is not None
    assert [rule.automaton for rule in pair.forms.plan.rules] == [None]
    run, shown = Run(pair, None, listens=False), []
    for t in range(300):
        values = {"p": t % 25 == 3, "q": t % 25 > 11, "r": t % 25 > 3}
        values["q"] = values["q"] != (t % 25 == 14)
        run.both(lambda monitor, t=t, values=values: [*map(repr, monitor.step(2 * t, values))])
    run.both(lambda monitor: shown.append(monitor.finish().attempts))
    assert run.found == []
    assert [repr(one) for one in shown[0]] == [repr(one) for one in shown[1]]
    assert {one.verdict.value for one in shown[1]} == {"P"}
    assert run.lending.taken > 200


FOLLOWED = """
spec s
time {}
signal p, q : bool
requirement R
  upon p then for 9 ns within 3 ns q
"""


@pytest.mark.parametrize("time", ["held", "sampled", "sampled every 3 ns"])
def test_both_say_the_same_where_c_steps_an_automaton_instead_of_windows(time):
    """It goes on from letters, and has them when Python goes on."""
    pair = compiled_beside(rvmon.loads(FOLLOWED.format(time)).checked)
    assert pair is not None
    assert [rule.automaton for rule in pair.forms.plan.rules] == [None]
    assert [rule.is_lettered for rule in pair.own.library.plan.rules] == [True]
    run, rng, t = Run(pair, None, listens=False), random.Random(time), 0
    for _ in range(600):
        t += rng.choice((1, 1, 2, 3, 7))
        values = {"p": rng.random() < 0.3, "q": rng.random() < 0.6}
        run.both(lambda monitor, t=t, values=values: [*map(repr, monitor.step_ns(t, values))])
        if rng.random() < 0.02:
            run.both(lambda monitor: [*map(repr, monitor.open)])
    run.both(lambda monitor: repr(monitor.finish().attempts))
    assert run.found == []
    assert run.lending.taken > 50


CROWDED = """
spec s
time {}
signal q : bool
event e
requirement R
  upon e then for 300 ns within 9 ns q
"""


@pytest.mark.parametrize("time", ["held", "sampled"])
def test_many_and_few_open_attempts_are_judged_alike(time):
    """C has a network judge many attempts at once, and goes back to the automaton."""
    pair = compiled_beside(rvmon.loads(CROWDED.format(time)).checked)
    assert pair is not None
    assert [rule.is_lettered for rule in pair.own.library.plan.rules] == [True]
    run, rng, most = Run(pair, None, listens=False), random.Random(time), 0
    for t in range(3000):
        values = {"q": rng.random() < (0.5 if t % 700 > 200 else 0.1), "e": t % 700 > 150}
        run.both(lambda monitor, t=t, values=values: [*map(repr, monitor.step_ns(t, values))])
        if t % 499 == 0:
            run.both(lambda monitor: len(monitor.open))
            most = max(most, len(run.plain.open))
    run.both(lambda monitor: repr(monitor.finish_ns(3000).attempts))
    assert run.found == []
    assert run.lending.taken > 2000
    assert most > 100


OPEN = "time held\nsignal q : bool\nrequirement R\n  always F[0 ns, 30 ns] G[0 ns, 9 ns] q\n"


def test_an_attempt_that_stays_open_is_judged_alike():
    """Over many more letters than are noted at once, and asked for now and then."""
    pair = compiled_beside(rvmon.loads(OPEN).checked)
    assert pair is not None
    assert [rule.automaton for rule in pair.forms.plan.rules] == [None]
    run = Run(pair, None, listens=False)
    asked = 0
    for t in range(1, 3000, 2):
        values = {"q": (t % 30 < 12 or t % 4 == 1) and t % 700 < 660}
        run.both(lambda monitor, t=t, values=values: [*map(repr, monitor.step_ns(t, values))])
        if t - asked > 130 + t % 120:
            asked = t
            run.both(lambda monitor: [*map(repr, monitor.open)])
    assert run.found == []
    run.both(lambda monitor: repr(monitor.finish_ns(3001).attempts))
    assert run.found == []
    assert run.lending.taken > 300


def test_letters_that_no_attempt_can_ask_for_take_no_room():
    """However long an attempt is open, C keeps those within the reach of its windows."""
    pair = compiled_beside(rvmon.loads(OPEN).checked)
    assert pair is not None
    assert [rule.automaton for rule in pair.forms.plan.rules] == [None]
    run = Run(pair, None, listens=False)
    tracemalloc.start()
    try:
        for t in range(0, 60_000, 3):
            assert not run.lending.step_ns(t, {"q": t % 30 < 15 or t % 2 == 0})
        taken, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert taken < 100_000
    run.lending.finish()
    assert run.lending.taken > 19_000
