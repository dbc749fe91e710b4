"""What time alone decides again and again while nothing comes: counted, not told one by one."""

import random

import pytest

import rvmon

STEP = 50
"""Seconds: so often one of both monitors is told that time passes, and the other never."""

TOLD = 990
"""At least so many failures of one silence are told one by one before the last two."""

FORMS = {
    "automaton": "always within 3 s hb",
    "bound": "always within 3 s (hb or p)",
    "past": "always ((within 1 s p) or (once[0, 2 s] hb))",
    "past of the trigger": "whenever once[0, 3500 s] hb then within 3 s p",
    "window": "always within 1 s for 1 s p",
    "window that opens later": "whenever not p then F[1 s, 2 s] hb",
    "windows": "always (within 2 s (hb and within 5 s p))",
    "network": "always (within 1 s (hb and (once[0, 3 s] p) and within 2 s q))",
    "network that looks back": "always (within 2 s once[0, 1 s] (p and within 1 s hb))",
}


CAPTURED = {
    "keys": "always within 3 s (beat and beat.id == k)\n  for each k in put.id",
    "keys that know their trigger": (
        "whenever x > k then within 2 s (beat and beat.id == k)\n  for each k in put.id"
    ),
    "let": "whenever not p\n  let v = x\n  then within 3 s x > v",
    "keys and let": "whenever p\n  let v = x\n  then within 2 s x > v + k\n  for each k in put.id",
}

ALL_TOLD = 100_000
"""So many failures of one silence, of all keys, are told before most of the others are not."""


def spec_of(form, time="held"):
    """A specification with two requirements, of which one repeats itself more often."""
    return rvmon.loads(
        f"spec s\ntime {time}\nevent hb\nsignal p : bool\nsignal q : bool\n"
        f"requirement R1\n  {form}\nrequirement R2\n  always within 7 s q\n"
    )


def run(spec, leap, *, in_steps):
    """A silence between two samples, at once or in steps."""
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
def test_what_is_counted_is_what_would_be_told(form, time):
    spec = spec_of(form, time)
    told, counted = (run(spec, 4_000, in_steps=steps) for steps in (True, False))
    assert not told.dropped
    assert told.verdicts == counted.verdicts
    assert told.counts == counted.counts
    for name in told.verdicts:
        all_, some = ([a for a in r.attempts if a.requirement == name] for r in (told, counted))
        assert [*map(outcome_of, all_[:TOLD])] == [*map(outcome_of, some[:TOLD])]
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
    """Some samples with keys, a silence, a sample with one of the keys."""
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
def test_numbers_of_several_keys_are_those_of_attempts_told_one_by_one(form, time):
    spec = of_keys(form, time)
    dropped = 0
    for seed in range(12):
        told, counted = (
            run_of_keys(spec, random.Random(seed), 9_000, in_steps=steps) for steps in (True, False)
        )
        assert (told.verdicts, told.counts) == (counted.verdicts, counted.counts)
        assert not told.dropped
        all_ = {(a.number, a.in_doubt): a for a in told.attempts}
        for some in counted.attempts:
            assert outcome_of(all_[some.number, some.in_doubt]) == outcome_of(some)
        assert all(all_[a.number, a.in_doubt] == a for a in counted.attempts[-8:])
        left_out = sum(sum(one.values()) for one in counted.dropped.values())
        assert len(all_) == len(counted.attempts) + left_out
        dropped += left_out
    assert dropped > 1_000


@pytest.mark.parametrize("form", CAPTURED.values(), ids=CAPTURED)
def test_of_many_keys_a_leap_by_years_is_told_in_bounded_memory(form):
    spec = of_keys(form)
    monitor = spec.monitor()
    for key in range(2_000):
        monitor.step(key / 1000, {"put": {"id": key % 1_000}, "x": 5000.0, "p": form[9] == "p"})
    monitor.step(1_700_000_000, {"x": 1.0})
    report = monitor.finish()
    assert len(report.attempts) < ALL_TOLD + 10_000
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
def test_a_window_of_which_as_much_goes_as_comes_is_at_rest(form):
    """Looked at on each tick, a leap of years would take years."""
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


def test_a_stamp_that_leaps_by_years_is_told_in_bounded_memory():
    """Of more failures than a count has room for, those are counted that have."""
    report = run(spec_of("always within 100 ms hb"), 1_700_000_000, in_steps=False)
    assert report.verdicts["R1"] == "F"
    assert len(report.attempts) < 4 * TOLD
    assert 240_000_000 < report.counts["R2"]["F"] < 1_700_000_000 / 7
    assert 2**32 - 2**21 < report.counts["R1"]["F"] < 2**32
