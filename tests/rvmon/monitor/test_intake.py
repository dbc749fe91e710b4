"""Samples with equal stamps, late ones, and what input health says of a run."""

import rvmon

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


def test_the_buffer_of_delayed_samples_is_bounded(monkeypatch):
    """When too many samples wait, the oldest are judged, and input health says so."""
    monkeypatch.setattr("rvmon.monitor.intake.MOST_HELD", 3)
    monitor = load("max delay 1 h").monitor()
    for t in range(6):
        monitor.step(t, {"x": 1})
    monitor.step(1, {"x": 2})
    found = {(one.name, one.count, one.first) for one in monitor.finish().health}
    assert {("buffer", 3, 0), ("x", 1, 10**9)} <= found
