"""The engine `auto` with compiled code beside it: nobody can tell but by speed."""

import random

import pytest
from tests.tools.differential import cases_of
from tests.tools.prepared import Run, compiled_beside, differences

import rvmon
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile, random_trace

pytestmark = pytest.mark.compiler

SPEC = """
spec s
signal p, q : bool
signal x : real stale after 10 s
requirement R1
  upon p then within 3 s q
requirement R2
  always (x > 5 -> once[0 s, 2 s] q)
"""


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    """A cache in which the specification is prepared; another one is empty."""
    folders = [str(tmp_path_factory.mktemp(name)) for name in ("prepared", "empty")]
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("RVMON_CACHE", raising=False)
        patch.setenv("XDG_CACHE_HOME", folders[0])
        rvmon.loads(SPEC).prepare()
    return folders


@pytest.fixture
def pair(cache, monkeypatch):
    """A monitor with compiled code beside it, and one without."""
    monkeypatch.delenv("RVMON_CACHE", raising=False)
    made = []
    for folder in cache:
        monkeypatch.setenv("XDG_CACHE_HOME", folder)
        made.append(rvmon.loads(SPEC).monitor())
    assert [one.judged_by for one in made] == ["c", "python"]
    return made


def lead(monitor, count, start=0):
    """Some samples of plain values; what they decided."""
    return [
        attempt
        for t in range(start, start + count)
        for attempt in monitor.step(
            float(t), {"p": t % 7 == 0, "q": t % 5 == 0, "x": float(t * 3 % 11)}
        )
    ]


@pytest.mark.parametrize("time", [TimeModel.HELD, TimeModel.SAMPLED])
@pytest.mark.parametrize("seed", range(2))
def test_both_say_the_same_of_random_cases(time, seed):
    """Records with reasons, what is open, errors, snapshots, reports."""
    profile = Profile(time=time, captures=False, for_each=False)
    traces = TraceProfile(samples=60, span=200, unknowns=seed == 0)
    for number in range(20):
        cases = [*cases_of(f"beside/{seed}/{number}", profile, traces, 10)]
        pair = compiled_beside(cases[0].spec)
        if pair is not None:
            found = [differences(pair, case, f"{seed}/{n}") for n, case in enumerate(cases)]
            assert [told for told, _ in found] == [[]] * len(cases)
            assert sum(taken for _, taken in found) > 0
            return
    raise AssertionError("no specification was taken")


WITHOUT_AUTOMATON = {
    "held": "always F[0 ns, 30 ns] G[0 ns, 9 ns] q",
    "sampled": "whenever p then ((F[2 ns, 7 ns] q) or (r U[0 ns, 9 ns] not q))",
    "sampled every 2 ns": "whenever p then F[4 ns, 10 ns] G[0 ns, 6 ns] (q or r)",
}


@pytest.mark.parametrize("time", WITHOUT_AUTOMATON)
def test_both_say_the_same_where_a_network_judges(time):
    """Joined windows, those of samples, and those of a clock."""
    text = f"time {time}\nsignal p, q, r : bool\nsignal x : real\nevent e\nrequirement R\n  "
    spec = rvmon.loads(f"{text}{WITHOUT_AUTOMATON[time]}\nrequirement S\n  upon e then q").checked
    pair = compiled_beside(spec)
    assert pair is not None
    rng = random.Random(time)
    traces = TraceProfile(samples=120, span=300, unknowns=False)
    found = [differences(pair, random_trace(rng, spec, traces), f"{n}") for n in range(3)]
    assert [told for told, _ in found] == [[]] * len(found)
    assert sum(taken for _, taken in found) > 0


def test_reports_are_the_same(pair):
    """With all that is read of them."""
    own, other = pair
    assert lead(own, 200) == lead(other, 200)
    found, wanted = own.finish(), other.finish()
    assert (found.engine, wanted.engine) == ("c", "python")
    assert found.attempts == wanted.attempts
    assert found.health == wanted.health


def test_callbacks_hear_of_what_c_decides(pair):
    """Also those that ask the monitor, which takes the state away from C."""
    own, _ = pair
    step = own.step
    lead(own, 20)
    heard = []
    own.on_decided(lambda attempt: heard.append((attempt.name, len(own.open))))
    made = [a.name for t in range(20, 60) for a in step(float(t), {"p": t % 7 == 0, "q": True})]
    assert made
    assert [name for name, _ in heard] == made


def test_records_are_dropped_alike(cache, monkeypatch):
    """With `keep`, the counts of what was not kept are the same."""
    monkeypatch.delenv("RVMON_CACHE", raising=False)
    reports = []
    for folder in cache:
        monkeypatch.setenv("XDG_CACHE_HOME", folder)
        monitor = rvmon.loads(SPEC).monitor(keep=2)
        lead(monitor, 2000)
        reports.append(monitor.finish())
    assert reports[0].dropped == reports[1].dropped
    assert reports[0].attempts == reports[1].attempts


def test_what_becomes_stale_is_told(pair):
    """Python takes the state back in time, by a sample or by `advance`."""
    for monitor in pair:
        lead(monitor, 30)
        monitor.step(50.0, {"q": True})
        lead(monitor, 30, start=60)
        monitor.advance(120.0)
    own, other = (monitor.finish() for monitor in pair)
    assert own.health == other.health
    assert any(one.kind == "stale" for one in own.health)
    assert own.attempts == other.attempts


def test_a_snapshot_goes_from_one_to_the_other(pair, cache, monkeypatch):
    """What C held is put away as Python would have."""
    own, other = pair
    lead(own, 50)
    lead(other, 50)
    kept = own.snapshot()
    monkeypatch.setenv("XDG_CACHE_HOME", cache[1])
    there = rvmon.loads(SPEC).restore(kept)
    assert there.judged_by == "python"
    assert lead(there, 50, start=50) == lead(other, 50, start=50)
    assert there.finish().attempts == other.finish().attempts


def test_what_is_wrong_is_refused_and_changes_nothing(pair):
    """Names, values and times, with the same words."""
    own, other = pair
    lead(own, 20)
    lead(other, 20)
    for t, values in ((20.0, {"z": 1}), (20.0, {"x": "high"}), (3.0, {"x": 1.0}), (21.0, [])):
        told = []
        for monitor in pair:
            with pytest.raises(rvmon.TraceError) as error:
                monitor.step(t, values)
            told.append(str(error.value))
        assert told[0] == told[1]
    assert lead(own, 20, start=20) == lead(other, 20, start=20)


MIXED = """
time held
signal p, q : bool
signal x, y : real
event go
event g(k : int)
event h(m : int)
requirement R1
  upon go then within 3 ns y > a let a = y
requirement R2
  upon p then within 3 ns q
requirement R3
  upon g.k == each then within 3 ns h.m == each for each each in g.k
requirement R4
  always sqrt(x) < 3
requirement R5
  upon go then within 3 ns q
"""
"""C takes R2 and R5; `let` and `for each` have evaluators, and R4 generated Python of its own."""


@pytest.fixture(scope="module")
def mixed():
    """A specification that C takes in part."""
    found = compiled_beside(rvmon.loads(MIXED).checked)
    assert found is not None
    assert [rule.requirement.id for rule in found.shared.plan.rules] == ["R2", "R5"]
    return found


def lent(mixed):
    """Two monitors, of which one has lent its state."""
    run = Run(mixed, None, listens=False)
    for t in range(5):
        told(run, t, {"p": False, "q": False, "x": 1.0, "y": 1.0})
    assert run.lending.alone > 0
    return run


def told(run, t, values):
    """Give a sample to both."""
    run.both(lambda monitor: [*map(repr, monitor.step_ns(t, values))])


def test_records_of_c_and_python_come_in_one_order(mixed):
    """What a sample decides in both: by instant, then by the place in the file."""
    run = lent(mixed)
    told(run, 5, {"go": True, "p": True, "g": {"k": 7}})
    found = [one.name for one in run.lending.step_ns(12, {"x": 16.0})]
    assert found == ["R1#1", "R2#1", "R3#1", "R5#1", "R4#1"]
    assert [one.name for one in run.lending.finish().attempts] == found


def test_c_takes_alone_what_is_nothing_new_to_python(mixed):
    """Names that it does not read, and values that it has."""
    run = lent(mixed)
    before = run.lending.alone
    for t in range(5, 25):
        told(run, t, {"p": t % 4 == 0, "x": 1.0, "y": 1.0})
    assert run.lending.alone - before == 20
    assert run.found == []


def test_a_sample_that_python_refuses_c_does_not_take(mixed, monkeypatch):
    """There may be too many instances; both go on as if it had not come."""
    monkeypatch.setattr("rvmon.monitor.attempts.instances.MOST_OPEN", 1)
    run = lent(mixed)
    told(run, 5, {"g": {"k": 7}, "p": True})
    told(run, 6, {"g": {"k": 8}, "q": True})
    told(run, 7, {"q": False})
    run.both(lambda monitor: repr(monitor.finish_ns(20).attempts))
    assert run.found == []


def test_both_say_the_same_where_c_takes_a_part(mixed):
    """Also behind snapshots, wrong samples and values that are not known."""
    rng = random.Random(1)
    traces = [TraceProfile(samples=60, span=200, unknowns=number == 0) for number in range(4)]
    cases = [random_trace(rng, mixed.compiled.checked, one) for one in traces]
    found = [differences(mixed, case, f"{n}") for n, case in enumerate(cases)]
    assert [told for told, _ in found] == [[]] * len(found)
    assert sum(taken for _, taken in found) > 0


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("always (p -> once[40 s, 40500 ms] q)", "remembers more than 60 stretches"),
        ("always x / y > 1", "may be unknown"),
        ("always sqrt(x) > 1", "may be unknown"),
        ("upon p then x > a let a = x", "uses `let`"),
        ("upon p then F[2 s, 5 s] (q and (F q) and F[1 s, 9 s] always p)", "has no automaton"),
    ],
)
def test_what_c_could_not_do_alike_is_not_taken(text, why):
    """It is said by `Spec.engines`, and decided once."""
    spec = rvmon.loads(
        f"time held\nsignal p, q : bool\nsignal x, y : real\nrequirement R1\n  {text}\n"
    )
    assert why in spec.engines()["R1"].refused["prepared"].reason
