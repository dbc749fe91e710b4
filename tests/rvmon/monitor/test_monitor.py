"""The online monitor, as used by a program."""

import math

import pytest
from tests.tools.each import each

import rvmon
from rvmon.errors import TraceError, UnknownNameError
from rvmon.verdicts import Verdict

SPEC = """
signal ready : bool
event sensed, released
requirement R1
  upon sensed and ready
  then within 3 s released
requirement R2
  upon sensed and not ready
  then for 2 s not released
"""


def brief(attempts):
    return [(a.requirement, a.number, a.verdict.value, a.decided) for a in attempts]


@pytest.fixture(name="monitor")
def _monitor():
    return rvmon.loads(SPEC).monitor()


def test_a_clock_restarted_at_each_tick_is_not_due():
    """A clock that runs from the last position moves with time, and decides nothing by itself."""
    text = "always ((F[0 ns, 20 ns] r) -> (p U r))"
    run = rvmon.loads(f"time held\nsignal p, r : bool\nrequirement R\n  {text}\n").monitor()
    run.step_ns(0, {"p": True, "r": False})
    assert run.next_due is None
    run.step_ns(100, {"p": False})
    assert brief(run.step_ns(105, {"r": True})) == [("R", 1, "F", 105)]


def test_next_due_says_when_to_call_advance(monitor):
    assert monitor.next_due is None
    monitor.step(0, {"ready": True})
    monitor.step(1, {"sensed": True})
    for _ in range(9):
        if monitor.next_due < 4_000_000_001:
            assert monitor.advance_ns(monitor.next_due) == ()
    assert monitor.next_due == 4_000_000_001
    assert brief(monitor.advance_ns(monitor.next_due)) == [("R1", 1, "F", 4_000_000_001)]
    monitor.advance_ns(4_000_000_002)
    assert monitor.next_due is None


@each("t", [math.inf, math.nan, 1e300])
@each("call", ["advance", "finish"])
def test_an_impossible_time_is_an_error(monitor, t, call):
    with pytest.raises(TraceError):
        getattr(monitor, call)(t)


def test_a_name_without_source_is_unknown_and_must_not_arrive():
    monitor = rvmon.loads(SPEC).monitor(sources=["sensed", "ready"])
    monitor.step(0, {"ready": True, "sensed": True})
    with pytest.raises(TraceError, match="not among the sources"):
        monitor.step(1, {"released": True})
    assert monitor.finish(9).verdicts["R1"] is Verdict.INCONCLUSIVE


@each("options", [{"only": ["R9"]}, {"settle": "never"}])
def test_an_unknown_option_is_named_with_those_there_are(options):
    with pytest.raises(UnknownNameError, match=r"there are R1|expected 'now' or 'next'"):
        rvmon.loads(SPEC).monitor(**options)


MANY = """
event go(id: int)
signal p : bool
requirement R
  upon go
  then within 1000 s p
requirement K
  upon go.id == i
  then within 1000 s p
  for each i in go.id
"""


@pytest.mark.slow
@pytest.mark.parametrize("keep", [None, 3])
def test_what_is_decided_together_is_made_as_it_is_read(keep):
    spec = rvmon.loads(MANY)
    count = 2_500
    monitor, heard = spec.monitor(keep=keep), []
    monitor.step_ns(0, {"p": False})
    for t in range(1, count + 1):
        monitor.step_ns(t, {"go": {"id": t}})
    stop = monitor.on_decided(heard.append)
    decided = monitor.step_ns(count + 1, {"p": True})
    stop()
    assert len(decided) == 2 * count
    assert not isinstance(decided, tuple)
    assert [a.name for a in decided] == [a.name for a in heard]
    assert {a.verdict for a in decided} == {"P"}
    last = decided[-1]
    assert last.captured == {"i": count}
    assert last.reason.startswith("`p` was true at")
    assert decided[:2] == [decided[0], decided[1]]
    report = monitor.finish()
    assert report.counts["K"]["P"] == count
    if keep is None:
        assert list(report.attempts) == sorted(
            decided, key=lambda a: (a.decided, a.requirement != "R", a.number)
        )
