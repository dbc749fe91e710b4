"""Notes of the core: records give their reasons correctly, whenever they are read."""

import gc
import pickle

import pytest

import rvmon

MS = 1_000_000


def spec_of(text):
    return rvmon.loads(f"spec watch\ntime held\n{text}")


RESPONSE = """
signal p, q : bool
requirement R "answer"
  upon rise(p)
  then within 5 ms q
requirement W "lasting"
  upon rise(p)
  then eventually[0 ms, 20 ms] always[0 ms, 3 ms] q
"""


@pytest.mark.slow
def test_a_reason_can_be_read_long_after_the_decision():
    monitor = spec_of(RESPONSE).monitor()
    monitor.step_ns(0, {"p": False, "q": False})
    monitor.step_ns(7 * MS, {"p": True})
    failed = [*monitor.advance_ns(13 * MS), *monitor.advance_ns(30 * MS)]
    copies = pickle.dumps(monitor.advance_ns(31 * MS)), list(failed)
    for t in range(32, 20_000):
        monitor.step_ns(t * MS, {"p": t % 2 == 0, "q": t % 7 == 0})
    monitor.reset()
    monitor.step_ns(0, {"p": True, "q": True})
    del monitor
    gc.collect()
    first, second = failed
    assert first.reason == (
        "`q` had to come true between 0.007 s and 0.012 s, and did not; "
        "it had never been true before"
    )
    assert dict(first.at_trigger) == {"p": True, "q": False}
    assert first.deadline == 12 * MS
    assert second.requirement == "W"
    assert second.reason.startswith("`for 3 ms q` had to come true between 0.007 s and 0.027 s")
    assert pickle.loads(pickle.dumps(copies[1])) == failed  # noqa: S301


def test_an_attempt_open_for_long_gives_the_reason_of_its_end():
    spec = spec_of(
        "signal p, q : bool\nrequirement U\n  upon start\n  then always (p -> within 3 ms q)\n"
    )
    core = spec.monitor()
    for t in range(10_000):
        core.step_ns(t * MS, {"p": t % 4 == 0, "q": t % 4 == 2 and t < 9_990})
    (failed, *_) = core.finish().attempts
    assert failed.verdict.name == "FAIL"
    assert failed.reason.startswith("`q` had to come true between 9.98")


def test_an_attempt_with_let_shows_the_event_that_starts_others():
    """Open attempts are not stepped by such an event, but their notes show it."""
    spec = rvmon.loads(
        "spec watch\ntime sampled every 1 ms\nsignal x : real\nevent e\nrequirement R\n"
        "  upon e\n  let v = x\n  then always[0, 9 ms] x < v + 3\n"
    )
    for occurs in (False, True):
        monitor = spec.monitor()
        for t in range(4):
            monitor.step_ns(t * MS, {"x": t / 2, "e": True})
        monitor.step_ns(4 * MS + 1, {"e": occurs})
        monitor.step_ns(4 * MS + 2, {"x": 3.2})
        failed = monitor.advance_ns(6 * MS)
        assert [(a.number, a.triggered, a.verdict.name) for a in failed] == [(1, 0, "FAIL")]
        assert dict(failed[0].at_trigger) == {"e": True, "x < v + 3": True}
        assert dict(failed[0].at_decision) == {"e": occurs, "x < v + 3": False}
