"""Monitors with lost sources and with samples that came too late."""

import random
from dataclasses import replace

import pytest
from msgspec import structs
from tests.tools.compare import differences
from tests.tools.drive import drive
from tests.tools.forms import Interrupted
from tests.tools.law import judge

import rvmon
from rvmon.errors import TraceError, UnknownNameError
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.monitor.monitor import build_monitor, restore
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import TraceProfile, random_trace
from rvmon.testing.law.word import Outage
from rvmon.trace.sample import HealthKind

SPEC = """spec s
{more}
signal x : real
signal other : bool
event go, done
requirement R
  upon go
  then within 3 s done
requirement Slow
  always x < 5
requirement Other
  always other
"""


def begun(more="", **options):
    monitor = rvmon.loads(SPEC.format(more=more)).monitor(**options)
    monitor.step(0, {"x": 1.0, "other": True})
    return monitor


def said(report):
    return "".join(str(verdict) for verdict in report.verdicts.values())


def lossy_cases(kind):
    """Cases with samples and an end only; each has a loss."""
    for seed in range(20):
        rng = random.Random(f"{kind} {seed}")
        spec = random_spec(rng, Profile(requirements=2, depth=2))
        case = random_trace(rng, spec, TraceProfile(outages=100, advances=False))
        if case.outages:
            last = [one.last for one in case.outages] + [one.t for one in case.samples]
            yield rng, replace(case, end=max([*last, case.end or 0]))


@pytest.mark.law
def test_delayed_samples_keep_the_order_of_losses():
    """With settle='next' and snapshots in between, each outage is that of the oracle."""
    for rng, case in lossy_cases("next"):
        monitor = build_monitor(compile_spec(case.spec), sources=case.names, settle="next")
        report, _ = drive(Interrupted(monitor, rng, share=0.2), case)
        assert differences(judge(case), report) == []


@pytest.mark.law
def test_a_stretch_is_wider_by_the_delay_that_samples_may_have():
    for rng, case in lossy_cases("delay"):
        delay = rng.randint(1, 5)
        case = replace(case, spec=structs.replace(case.spec, max_delay=delay))
        monitor = build_monitor(compile_spec(case.spec), sources=case.names)
        arrivals = [(one.t + rng.randint(0, delay), one.t, one) for one in case.actions]
        wider = [
            replace(one, first=one.first - delay, last=one.last + delay) for one in case.outages
        ]
        losses = [(one.first, one.first - delay - 1, one) for one in case.outages]
        for _, _, one in sorted([*arrivals, *losses], key=lambda found: found[:2]):
            if isinstance(one, Outage):
                monitor.lose_ns(one.names, one.first, one.last)
            else:
                monitor.step_ns(one.t, one.values)
        end = max(case.end, max(one.last for one in wider))
        report = monitor.finish_ns(end)
        expected = judge(replace(case, end=end, outages=tuple(wider)))
        assert differences(expected, report) == []


def test_what_is_lost_fails_nothing_and_passes_nothing():
    monitor = begun()
    monitor.step(1, {"go": True})
    monitor.lose(["done", "x"], since=2, until=3, why="the radio was silent")
    monitor.step(5, {"x": 1.0})
    report = monitor.finish(9)
    assert said(report) == "IIP"
    found = {(one.kind, one.name, one.first, one.requirements) for one in report.health}
    assert (HealthKind.DROPPED, "done", 2 * 10**9, ("R",)) in found
    assert (HealthKind.DROPPED, "x", 2 * 10**9, ("Slow",)) in found


def test_an_outage_within_another_does_not_end_it():
    """Nor do missed samples end while their connection is down."""
    monitor = begun()
    monitor.lose(["x"], since=1)
    monitor.lose(["x"], since=2, until=3)
    monitor.miss(["x"])
    monitor.step(5, {"other": True})
    monitor.lose(["other"], since=2, until=3)  # decided time cannot be lost any more
    assert not monitor.step(6, {"x": 9.0})
    monitor.found(None, at=7)
    assert [one.name for one in monitor.step(8, {"x": 9.0})] == ["Slow#1"]
    assert monitor.finish(9).verdicts["Other"] == "I"


@pytest.mark.parametrize(("settle", "expected"), [("now", "FPP"), ("next", "IPP")])
def test_missed_samples_are_lost_between_two_samples(settle, expected):
    """They may have the stamp of the next one if equal stamps are one sample."""
    monitor = begun(settle=settle)
    monitor.step(1, {"go": True})
    monitor.miss(["done"], why="a line that cannot be read")
    monitor.step(5, {"go": True})
    monitor.advance(9)
    report = monitor.finish()
    assert said(report) == expected
    assert next(one.triggered for one in report.attempts if one.verdict == "I") == 10**9


def test_nothing_passes_with_samples_missed_before_the_first_one():
    """Their stamps are unknown."""
    monitor = rvmon.loads(SPEC.format(more="")).monitor()
    monitor.miss()
    monitor.step(0, {"x": 1.0, "other": True})
    assert said(monitor.finish(1)) == "III"


@pytest.mark.parametrize("time", ["held", "sampled", "sampled every 1 s"])
@pytest.mark.parametrize("settle", ["now", "next"])
def test_nothing_passes_with_samples_missed_after_the_last_one(time, settle):
    """They may be at any later instant, and fail there: the end of the trace is not known."""
    for does_miss, expected in ((False, "NTPP"), (True, "III")):
        monitor = begun(f"time {time}", settle=settle)
        monitor.step(0.5, {"x": 2.0})
        if does_miss:
            monitor.miss()
        assert said(monitor.finish()) == expected


@pytest.mark.parametrize("settle", ["now", "next"])
def test_the_trace_extends_to_a_loss_within_another_one(settle):
    """Also for missed samples: a clock ticks up to there, and nothing is known at its ticks."""
    monitor = begun("time sampled every 1 s", settle=settle)
    monitor.step(0.5, {"x": 2.0})
    monitor.miss()
    monitor.lose(["x"], 3, 4)
    report = monitor.finish()
    assert (report.end, said(report)) == (4_000_000_000, "III")


def test_what_comes_too_late_leaves_nothing_green_that_reads_it():
    monitor = begun("max delay 1 s")
    monitor.step(10, {"go": True, "other": False})
    monitor.step(12, {"done": True})
    monitor.step(20, {"x": 1.0})
    assert monitor.verdicts == {"R": "P", "Slow": "NT", "Other": "F"}
    assert monitor.step(11, {"done": False, "other": True, "x": 1.0}) == ()
    assert monitor.verdicts == {"R": "I", "Slow": "NT", "Other": "F"}
    report = restore(monitor.compiled, monitor.snapshot()).finish()
    assert said(report) == "IIF"
    assert {"P", "F"} <= {str(one.verdict) for one in report.attempts}
    late = [one for one in report.health if one.kind is HealthKind.LATE]
    assert [(one.name, one.remark) for one in late] == [
        ("done", "left out"),
        ("other", "left out"),
        ("x", "left out"),
    ]


def test_the_buffer_of_delayed_samples_is_bounded(monkeypatch):
    """When too many samples wait, the oldest are judged, and input health says so."""
    monkeypatch.setattr("rvmon.monitor.intake.MOST_HELD", 3)
    monitor = rvmon.loads(SPEC.format(more="max delay 1 h")).monitor()
    for t in range(6):
        monitor.step(t, {"x": 1})
    monitor.step(1, {"x": 2})
    found = {(one.name, one.count, one.first) for one in monitor.finish().health}
    assert {("buffer", 3, 0), ("x", 1, 10**9)} <= found


def test_a_sample_that_is_refused_can_be_told_to_have_come_too_late():
    monitor = begun()
    monitor.step(5, {"x": 2.0})
    with pytest.raises(TraceError):
        monitor.step(4, {"x": 9.0})
    monitor.late(["x"], 4)
    assert said(monitor.finish(6)) == "NTIP"
    monitor.reset()
    monitor.step(0, {"x": 1.0, "other": True})
    monitor.late(None, 0)
    assert said(monitor.finish(6)) == "III"


def test_nothing_is_lost_that_is_not_declared():
    monitor = begun()
    with pytest.raises(UnknownNameError, match="`y`"):
        monitor.lose(["x", "y"], since=1)
    with pytest.raises(UnknownNameError, match="`y`"):
        monitor.late(["y"], 0)
    assert said(monitor.finish(1)) == "NTPP"
    for call in (
        lambda: monitor.lose(None, 2),
        lambda: monitor.miss(),
        lambda: monitor.found(None, 2),
    ):
        with pytest.raises(TraceError, match="finished"):
            call()


def test_an_attempt_decided_after_an_outage_has_no_robustness():
    """The sign of the part before the outage could contradict the verdict."""
    text = "time sampled\nsignal x : real\nrequirement R\n  upon start\n  then for 10 s x <= 5\n"
    spec = rvmon.loads(text)
    judged, measured = spec.monitor(), spec.robustness_monitor()
    for one in (judged, measured):
        one.step(0, {"x": 4.5})
    judged.lose(["x"], since=2, until=3)
    [figure] = [one for one in measured.lose(["x"], since=2, until=3) if one.t == 0]
    [attempt] = [one for one in judged.step(4, {"x": 9.0}) if one.triggered == 0]
    assert (attempt.verdict, figure.robustness.high) == (rvmon.Verdict.FAIL, 0.5)
    assert figure.robustness.of(attempt) is None


@pytest.mark.slow
def test_distinct_reasons_of_losses_take_bounded_memory():
    """As from a program that puts a line number into each reason."""
    monitor = begun()
    for number in range(1_500):
        monitor.late(["x"], 0, why=f"line {number}")
    found = [one for one in monitor.finish(1).health if one.kind is HealthKind.LATE]
    assert len(found) < 1_100
    assert sum(one.count for one in found) == 1_500
