"""Samples with equal stamps, late ones, and what input health says of a run."""

import pytest

import rvmon
from rvmon.errors import TimeOrderError
from rvmon.trace.sample import HealthKind

SPEC = """spec s
time held
{delay}
signal x : real input stale after 2 s
signal unread : bool input
event go, done input
requirement R
  upon go
  then within 3 s (done and x > 0)
"""


def load(delay=""):
    return rvmon.loads(SPEC.format(delay=delay))


def test_equal_stamps_are_merged_and_judged_when_the_next_stamp_settles_them():
    """With settle='next' the order of updates within one instant does not matter."""
    monitor = load().monitor(settle="next")
    monitor.step(0, {"x": 1})
    monitor.step(1, {"done": True})
    assert monitor.step(1, {"go": True}) == ()
    [passed] = monitor.step(2, {})
    assert (passed.verdict, passed.decided) == ("P", 10**9)
    with pytest.raises(TimeOrderError):
        monitor.step(1, {})


def test_advance_and_finish_settle_too():
    """A sample that is held back is judged when no other can come at its instant."""
    monitor = load().monitor(settle="next")
    monitor.step(0, {"x": 1, "go": True, "done": True})
    assert monitor.advance(0) == ()
    assert [a.verdict for a in monitor.advance(0.1)] == ["P"]
    monitor.step(1, {"x": 1, "go": True, "done": True})
    assert [a.number for a in monitor.finish().attempts] == [1, 2]


def test_the_buffer_of_delayed_samples_is_bounded(monkeypatch):
    """When too many samples wait, the oldest are judged, and input health says so."""
    monkeypatch.setattr("rvmon.monitor.intake.MOST_HELD", 3)
    monitor = load("max delay 1 h").monitor()
    for t in range(6):
        monitor.step(t, {"x": 1})
    monitor.step(1, {"x": 2})
    found = {(one.name, one.count, one.first) for one in monitor.finish().health}
    assert {("buffer", 3, 0), ("x", 1, 10**9)} <= found


def test_samples_are_put_in_order_within_the_allowed_delay():
    """What comes late but in time is judged at its instant; what comes later is counted."""
    monitor = load("max delay 1 s").monitor()
    monitor.step(0, {"x": 1})
    monitor.step(2, {"done": True})
    monitor.step(1, {"go": True})
    assert monitor.step(0.5, {"go": True}) == ()
    report = monitor.finish()
    assert [(a.triggered, a.verdict.value, a.decided) for a in report.attempts] == [
        (10**9, "P", 2 * 10**9)
    ]
    [late] = [h for h in report.health if h.kind is HealthKind.LATE]
    assert (late.count, late.first) == (1, 5 * 10**8)


def test_health_lists_what_was_not_known_and_who_reads_it():
    """Missing, None, NaN and stale values are counted per signal with their first instant."""
    monitor = load().monitor()
    monitor.step(1, {"go": True})
    monitor.step(2, {"x": float("nan")})
    monitor.step(3, {"x": None})
    monitor.step(4, {"x": None})
    monitor.step(5, {"x": 1})
    report = monitor.finish(9)
    found = {h.kind: (h.name, h.count, h.first, h.requirements) for h in report.health}
    assert found == {
        HealthKind.MISSING: ("x", 1, 10**9, ("R",)),
        HealthKind.NAN: ("x", 1, 2 * 10**9, ("R",)),
        HealthKind.NONE: ("x", 2, 3 * 10**9, ("R",)),
        HealthKind.STALE: ("x", 1, 7 * 10**9 + 1, ("R",)),
    }


def test_health_lists_names_without_source():
    """A name that cannot arrive is absent; one that nobody reads is no trouble."""
    monitor = load().monitor(sources=["go", "x"])
    monitor.step(0, {"x": 1})
    assert [(h.kind, h.name) for h in monitor.finish().health] == [(HealthKind.ABSENT, "done")]


def test_two_values_at_one_stamp_are_a_conflict():
    """The later value in source order is judged, and the conflict reported."""
    monitor = load().monitor(settle="next")
    monitor.step(0, {"x": 1, "go": True})
    monitor.step(0, {"x": 2})
    [conflict] = monitor.finish().health
    assert (conflict.kind, conflict.name, conflict.requirements) == (
        HealthKind.CONFLICT,
        "x",
        ("R",),
    )
