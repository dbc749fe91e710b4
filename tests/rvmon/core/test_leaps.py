"""Long silences: the failures that time alone decides are counted instead of listed one by one."""

import random

import pytest

import rvmon

STEP = 50
"""Seconds between calls of `advance`, where a silence is passed in steps."""

LISTED = 990
"""At least this many failures of one silence are listed before the last two."""

FORMS = {
    "automaton": "always within 3 s hb",
    "bound": "always within 3 s (hb or p)",
    "past": "always ((within 1 s p) or (once[0, 2 s] hb))",
    "past of the trigger": "whenever once[0, 3500 s] hb then within 3 s p",
    "window": "always within 1 s for 1 s p",
    "delayed window": "whenever not p then F[1 s, 2 s] hb",
    "windows": "always (within 2 s (hb and within 5 s p))",
    "network": "always (within 1 s (hb and (once[0, 3 s] p) and within 2 s q))",
    "network with a past": "always (within 2 s once[0, 1 s] (p and within 1 s hb))",
}


CAPTURED = {
    "keys": "always within 3 s (beat and beat.id == k)\n  for each k in put.id",
    "keys in the trigger": (
        "whenever x > k then within 2 s (beat and beat.id == k)\n  for each k in put.id"
    ),
    "let": "whenever not p\n  let v = x\n  then within 3 s x > v",
    "keys and let": "whenever p\n  let v = x\n  then within 2 s x > v + k\n  for each k in put.id",
}

ALL_LISTED = 100_000
"""Failures of one silence, of all keys together, that are listed before most are only counted."""


def spec_of(form, time="held"):
    """Two requirements that fail again and again at different rates."""
    return rvmon.loads(
        f"spec s\ntime {time}\nevent hb\nsignal p : bool\nsignal q : bool\n"
        f"requirement R1\n  {form}\nrequirement R2\n  always within 7 s q\n"
    )


def run(spec, leap, *, in_steps):
    """Judge a silence between two samples, in one leap or in steps."""
    monitor = spec.monitor()
    monitor.step(0, {"hb": True, "p": False, "q": False})
    for t in range(STEP, leap, STEP) if in_steps else ():
        monitor.advance(t)
    monitor.step(leap, {"hb": True, "q": True})
    return monitor.finish(leap + 1)


def outcome_of(attempt):
    return attempt.number, attempt.triggered, attempt.decided, attempt.verdict


@pytest.mark.slow
@pytest.mark.parametrize("time", ["held", "sampled every 500 ms"])
@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_a_leap_counts_the_failures_that_steps_list(form, time):
    spec = spec_of(form, time)
    listed, counted = (run(spec, 4_000, in_steps=steps) for steps in (True, False))
    assert not listed.dropped
    assert listed.verdicts == counted.verdicts
    assert listed.counts == counted.counts
    for name in listed.verdicts:
        all_, some = ([a for a in r.attempts if a.requirement == name] for r in (listed, counted))
        assert [*map(outcome_of, all_[:LISTED])] == [*map(outcome_of, some[:LISTED])]
        for some_ in (slice(30), slice(-2, None)):
            assert all_[some_] == some[some_]
            assert [a.reason for a in all_[some_]] == [a.reason for a in some[some_]]
        assert len(some) == len(all_) - sum(counted.dropped.get(name, {}).values())


def of_keys(form, time="held"):
    return rvmon.loads(
        f"spec s\ntime {time}\nevent put(id : int), beat(id : int)\nsignal p : bool\n"
        f"signal x : real\nrequirement R1\n  {form}\n"
    )


def run_of_keys(spec, rng, leap, *, in_steps):
    """Judge samples with keys, a silence, and a sample with one of the keys."""
    monitor, t = spec.monitor(), 0.0
    for _ in range(rng.randint(3, 8)):
        update = {"put": {"id": rng.randint(1, 4)}, "x": float(rng.randint(2, 6))}
        if rng.random() < 0.4:
            update["beat"] = {"id": rng.randint(1, 4)}
        monitor.step(t, update | {"p": rng.random() < 0.5})
        t += rng.choice([0.5, 1, 1 + 1e-9, rng.uniform(0, 4)])
    for step in range(int(t) + STEP, leap, STEP) if in_steps else ():
        monitor.advance(step)
    monitor.step(leap, {"x": 1000.0, "p": True, "beat": {"id": 1}})
    return monitor.finish(leap + 1)


@pytest.mark.slow
@pytest.mark.parametrize("time", ["held", "sampled every 500 ms"])
@pytest.mark.parametrize("form", CAPTURED.values(), ids=CAPTURED)
def test_a_leap_numbers_the_attempts_of_several_keys_as_steps_do(form, time):
    spec = of_keys(form, time)
    dropped = 0
    for seed in range(12):
        listed, counted = (
            run_of_keys(spec, random.Random(seed), 9_000, in_steps=steps) for steps in (True, False)
        )
        assert (listed.verdicts, listed.counts) == (counted.verdicts, counted.counts)
        assert not listed.dropped
        all_ = {(a.number, a.in_doubt): a for a in listed.attempts}
        for some in counted.attempts:
            assert outcome_of(all_[some.number, some.in_doubt]) == outcome_of(some)
        assert all(all_[a.number, a.in_doubt] == a for a in counted.attempts[-8:])
        left_out = sum(sum(one.values()) for one in counted.dropped.values())
        assert len(all_) == len(counted.attempts) + left_out
        dropped += left_out
    assert dropped > 1_000


@pytest.mark.parametrize("form", CAPTURED.values(), ids=CAPTURED)
def test_a_leap_of_years_with_many_keys_takes_bounded_memory(form):
    spec = of_keys(form)
    monitor = spec.monitor()
    for key in range(2_000):
        monitor.step(key / 1000, {"put": {"id": key % 1_000}, "x": 5000.0, "p": form[9] == "p"})
    monitor.step(1_700_000_000, {"x": 1.0})
    report = monitor.finish()
    assert len(report.attempts) < ALL_LISTED + 10_000
    failed = sum(counts["F"] for counts in report.counts.values())
    assert 500_000_000 < failed < 2**32


@pytest.mark.parametrize(
    "form",
    [
        "count(p, 1 s) - x < 2000",
        "-count(p, 1 s) < x",
        "share(p, 1 s) * x < 2",
        "sum(x, 1 s) * x < 2000",
        "count(max(x, 1 s) < 10, 3 s) - x < 4000",
    ],
)
def test_a_window_whose_number_no_longer_changes_is_not_evaluated_at_each_tick(form):
    """Otherwise a leap of years would not end."""
    spec = rvmon.loads(
        "time sampled every 1 ms\nsignal p : bool\nsignal x : real\n"
        f"requirement R\n  always {form}\n"
    )
    monitor = spec.monitor()
    monitor.step(0, {"p": True, "x": 1})
    monitor.step(1_700_000_000, {"x": 10_000})
    assert [a.decided for a in monitor.finish().attempts if a.verdict == "F"] == (
        [] if "-" in form else [1_700_000_000 * 10**9]
    )


def test_a_leap_of_years_takes_bounded_memory_and_counts_up_to_32_bits():
    report = run(spec_of("always within 100 ms hb"), 1_700_000_000, in_steps=False)
    assert report.verdicts["R1"] == "F"
    assert len(report.attempts) < 4 * LISTED
    assert 240_000_000 < report.counts["R2"]["F"] < 1_700_000_000 / 7
    assert 2**32 - 2**21 < report.counts["R1"]["F"] < 2**32
