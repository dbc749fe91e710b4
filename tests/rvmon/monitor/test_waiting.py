"""A long-running monitor: verdicts so far, callbacks, and records that are dropped."""

import pytest
from tests.tools.each import each

import rvmon
from rvmon.errors import RvmonError, TraceError
from rvmon.trace.sample import HealthKind

SPEC = """
spec watch
time held
signal x : real
signal y : real
event e, stop, beat
requirement L1 "level"
  always x <= 3
requirement U1 "edge"
  upon e
  then within 3 s stop
requirement Y1 "reads what may be lost"
  upon e
  then immediately y > 0
requirement B1 "a heart that beats"
  always within 3 s beat
"""


def samples(count):
    """Samples a second apart, in which each requirement passes, fails and stays open."""
    for i in range(count):
        values = {"x": 5.0 if i % 4 == 1 else 1.0}
        if i == 0:
            values["y"] = 1.0
        if i % 20 == 10:
            values["y"] = None
        elif i % 20 == 15:
            values["y"] = float(i % 3 - 1)
        values |= {"e": True} if i % 2 else {}
        values |= {"stop": True} if i % 5 == 0 else {}
        values |= {"beat": True} if i % 7 < 3 else {}
        yield i * 10**9, values


def key(attempt):
    return (attempt.requirement, attempt.number, attempt.in_doubt, attempt.verdict.value)


@pytest.fixture(name="spec", scope="module")
def _spec():
    return rvmon.loads(SPEC)


def test_verdicts_so_far_fold_the_returned_attempts(spec):
    """F if an attempt failed, else P if one passed, else NT, after each call."""
    monitor = spec.monitor()
    seen = {name: set() for name in spec.requirements}
    assert set(monitor.verdicts.values()) == {"NT"}
    for t, values in samples(60):
        for attempt in monitor.step_ns(t, values):
            seen[attempt.requirement].add(attempt.verdict)
        expected = {
            name: next((one for one in ("F", "P") if one in own), "NT")
            for name, own in seen.items()
        }
        assert monitor.verdicts == expected
    assert monitor.verdicts == {"L1": "F", "U1": "F", "Y1": "F", "B1": "F"}
    report = monitor.finish()
    assert monitor.verdicts == report.verdicts
    monitor.reset()
    assert set(monitor.verdicts.values()) == {"NT"}


def test_what_is_undecided_does_not_count_so_far(spec):
    monitor = spec.monitor(only=["U1"])
    monitor.step(0, {"e": True})
    assert monitor.verdicts == {"U1": "NT"}
    monitor.step(1, {"stop": True})
    monitor.step(2, {"e": True})
    assert monitor.verdicts == {"U1": "P"}
    assert monitor.finish().verdicts == {"U1": "I"}
    assert monitor.verdicts == {"U1": "I"}


@pytest.mark.parametrize("settle", ["now", "next"])
def test_callbacks_hear_of_each_decision_once_in_order(spec, settle):
    monitor = spec.monitor(settle=settle)
    heard, failed, returned = [], [], []
    monitor.on_decided(heard.append)
    monitor.on_failure(failed.append)
    for t, values in samples(60):
        returned += monitor.step_ns(t, values)
        returned += monitor.advance_ns(t + 5 * 10**8)
        assert heard[: len(returned)] == returned
        assert len(heard) == len(returned)
    report = monitor.finish(70)
    decided = [one for one in report.attempts if one.decided is not None]
    assert sorted(map(key, heard)) == sorted(map(key, decided))
    assert failed == [one for one in heard if one.verdict == "F"]
    assert len(failed) > 20
    monitor.finish()
    assert len(heard) == len(decided)


def test_a_callback_can_be_taken_away_and_stays_over_a_reset(spec):
    monitor = spec.monitor(only=["L1"])
    heard = []
    stop = monitor.on_failure(heard.append)
    for _ in "12":
        monitor.step(0, {"x": 5})
        monitor.reset()
    assert [one.decided for one in heard] == [0, 0]
    stop()
    stop()
    assert len(monitor.step(2, {"x": 5})) == 1
    assert len(heard) == 2
    monitor.on_failure(heard.append)
    monitor.step(3, {"x": 1})
    monitor.step(4, {"x": 5})
    assert len(heard) == 3
    with pytest.raises(RvmonError, match="takes an attempt, found 3"):
        monitor.on_failure(3)


def test_what_a_callback_raises_leaves_the_monitor_in_order(spec):
    plain, monitor = spec.monitor(), spec.monitor()
    heard = []

    def broken(attempt):
        raise ValueError(attempt.requirement)

    monitor.on_failure(broken)
    monitor.on_decided(heard.append)
    raised = 0

    def call(method, *given):
        nonlocal raised
        try:
            getattr(monitor, method)(*given)
        except* ValueError:
            raised += 1

    for t, values in samples(40):
        call("step_ns", t, values)
        call("advance_ns", t + 3 * 10**8)
        with pytest.raises(TraceError):
            monitor.step_ns(t + 2 * 10**8, {})
        plain.step_ns(t, values)
        plain.advance_ns(t + 3 * 10**8)
    call("finish", 60)
    assert raised > 10
    report = plain.finish(60)
    assert monitor.finish() == report
    assert len(heard) == sum(one.decided is not None for one in report.attempts)


UNDECIDED = {
    "what unknown input has left without a way out": (
        "signal y : real\nevent e\nrequirement Y1\n  upon e\n  then immediately y > 0\n",
        [{"y": None}, *({"e": True} for _ in range(399))],
        *(399, 130),
    ),
    "attempts in doubt: episodes whose trigger is lost, one after the other": (
        "signal p, q : bool\nrequirement W1\n  whenever p\n  then q\n"
        "requirement U1\n  upon p\n  then within 5 ms q\n",
        [{"p": None if t % 2 else False, "q": False} for t in range(120)],
        *(120, 80),
    ),
    "episodes that were over before all that is required had a value": (
        "signal p, q : bool\nrequirement W1\n  whenever p\n  then q\n",
        [{"p": bool(t % 2)} for t in range(160)],
        *(80, 66),
    ),
    "what has judges of its own, per key or per attempt": (
        "signal y, s : real\nevent e(id: int)\n"
        "requirement K1\n  upon e\n  then immediately y > 0\n  for each k in e.id\n"
        "requirement C1\n  upon e\n  then immediately y > v\n  let v = s\n",
        [{"s": 1.0, "y": None}, *({"e": {"id": t % 5}} for t in range(89))],
        *(178, 140),
    ),
}
"""Specifications, samples, and how much is open at their end: if all is kept, and at most."""


@pytest.mark.parametrize("name", UNDECIDED)
def test_what_is_undecided_for_good_is_bounded(name):
    text, rows, all_open, most = UNDECIDED[name]
    spec = rvmon.loads(text)
    plain, monitor = spec.monitor(), spec.monitor(keep=4)
    for t, values in enumerate(rows):
        assert monitor.step(t, values) == plain.step(t, values)
    assert len(plain.open) == all_open
    assert len(monitor.open) < most
    expected, report = plain.finish(), monitor.finish()
    assert report.counts == expected.counts
    for one in spec.requirements:
        assert list(map(key, report.of(one, "I"))) == list(map(key, expected.of(one, "I")))[-4:]
        assert report.dropped[one]["I"] == expected.counts[one]["I"] - 4


@pytest.mark.parametrize("only", [None, ["L1"], ["U1"], ["Y1"], ["B1"]], ids=str)
def test_a_run_that_keeps_few_records_does_not_grow(spec, only):
    """Nor do notes for reasons: a snapshot after hours is as long as after minutes."""
    plain, monitor = (spec.monitor(only=only, keep=3) for _ in "12")
    sizes = []
    for index, (t, values) in enumerate(samples(8_000)):
        plain.step_ns(t, values)
        monitor.step_ns(t, values)
        if index % 500 == 499:
            sizes.append(len(monitor.snapshot()))
            monitor = spec.restore(monitor.snapshot())
            assert monitor.verdicts == plain.verdicts
    assert max(sizes[8:]) <= 1.1 * max(sizes[:8])
    assert monitor.finish() == plain.finish()
    assert monitor.finish().dropped


@each("keep", [-1, 2.0, True, "3"])
def test_what_is_no_count_is_refused(spec, keep):
    with pytest.raises(RvmonError, match="whole number from 0 on"):
        spec.monitor(keep=keep)


def test_of_much_that_is_open_the_oldest_is_enough():
    text = SPEC.replace("within 3 s stop", "within 9 s stop")
    monitor = rvmon.loads(text).monitor(only=["U1", "L1"])
    for t in range(4):
        monitor.step(t, {"e": True, "beat": t == 3, "x": 0.0, "y": 1.0})
    counts, records = monitor.open_counts(2)
    assert counts["U1"] == 4
    assert sum(counts.values()) == len(monitor.open)
    assert {one.name: one.deadline for one in records} == {"L1#1": None, "U1#1": 9_000_000_000}
    assert [one.required for one in records if one.deadline] == ["`within 9 s stop` by 9 s"]
    assert all(one in monitor.open for one in records)
    assert monitor.open_counts() == (counts, monitor.open)


_MERGED = rvmon.loads("""
signal x : real
signal n : int
event pick(id: int)
requirement R
  always x < 5
requirement S
  upon pick
  then immediately pick.id < 10
requirement T
  upon n > 3
  then false
""")


@each("number", [1 << 63, -(1 << 70)])
def test_a_number_too_large_is_refused_before_it_waits(number):
    """Otherwise the next sample would be refused for it, and this one lost."""
    monitor = _MERGED.monitor(settle="next")
    monitor.step(0, {"x": 1.0, "n": 0})
    with pytest.raises(TraceError, match="`n` is a number too large for 64 bits"):
        monitor.step(1, {"x": 9.0, "n": number})
    monitor.step(1, {"x": 9.0})
    monitor.step(2, {"n": 0})
    monitor.step(3, {"x": 1.0})
    assert monitor.finish().verdicts["R"] == "F"


@each(
    ("ids", "verdict"),
    [((3,), "P"), ((3, 3), "P"), ((50, 50), "F"), ((3, 50), "I"), ((3, 3, 50), "I")],
)
def test_two_payloads_at_one_instant_keep_their_common_fields(ids, verdict):
    """A file or step with both is refused; in merged samples the other fields are unknown."""
    monitor = _MERGED.monitor(settle="next", only=["S"])
    for number in ids:
        monitor.step(1, {"pick": {"id": number}})
    report = monitor.finish(2)
    assert report.verdicts["S"] == verdict
    conflicts = [one.name for one in report.health if one.kind is HealthKind.CONFLICT]
    assert conflicts == ["pick"] * (verdict == "I")
