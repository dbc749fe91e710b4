"""After Ctrl-C anywhere within a step, a monitor continues with what it knows."""

import dis
import sys
from collections.abc import Iterator
from types import CodeType, FrameType
from typing import Any

import pytest

import rvmon
from rvmon.monitor.monitor import Monitor
from rvmon.report.junit import junit_xml
from rvmon.report.wording import health_facts
from rvmon.trace.sample import HealthKind
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report

pytestmark = pytest.mark.law

_SPEC = """spec s
signal x, y : real
event e, p, f, q
requirement R1
  always x <= 3
requirement R2
  upon e
  then within 1 s p
requirement R3
  always y <= 3
requirement R4
  upon f
  then within 1 s q
"""
_S = 1_000_000_000

Place = tuple[CodeType, int]


class _Odd(dict[str, object]):
    """A sample that needs the slow way."""


class _Strike:
    """A trace function that interrupts rvmon once at a place where a signal handler may run.

    Python checks for signals when a Python function starts, after a call, and on the way back in
    a loop; nowhere else, so that statements without these are taken whole.

    Args:
        at: the place where it does that; `None`: nowhere.
    """

    def __init__(self, at: Place | None = None) -> None:
        self.at = at
        self.passed: dict[Place, None] = {}
        """Where it could have been."""

    def __call__(self, frame: FrameType, _: str, __: object) -> Any:
        code = frame.f_code
        ours = "rvmon" in code.co_filename
        if not ours or (self.at is not None and self.at[0] is not code):
            return None
        frame.f_trace_opcodes = True
        frame.f_trace_lines = False
        self._pass(code, -1)
        looks = False

        def trace(frame: FrameType, event: str, _: object) -> Any:
            nonlocal looks
            if event == "opcode":
                if looks:
                    self._pass(code, frame.f_lasti)
                operation = dis.opname[code.co_code[frame.f_lasti]]
                looks = operation.startswith(("CALL", "JUMP_BACKWARD"))
            return trace

        return trace

    def _pass(self, code: CodeType, offset: int) -> None:
        self.passed[code, offset] = None
        if self.at == (code, offset):
            raise KeyboardInterrupt


def _begun(spec: rvmon.Spec) -> Monitor:
    monitor = spec.monitor()
    monitor.step_ns(1 * _S, {"x": 1.0, "y": 1.0, "e": False, "p": False, "f": True, "q": False})
    monitor.step_ns(2 * _S, {"x": 1.0, "y": 4.0, "e": True, "p": False, "f": False, "q": True})
    return monitor


def _struck(monitor: Any, strike: _Strike) -> None:
    """A step in which R1 fails, an attempt of R2 starts and one ends; others are not affected."""
    row = _Odd({"x": 4.0, "e": True, "p": True})
    before = sys.gettrace()
    sys.settrace(strike)
    try:
        monitor.step_ns(3 * _S, row)
    finally:
        sys.settrace(before)


def _passed(spec: rvmon.Spec) -> tuple[list[Place], Monitor]:
    """The places at which the step can be interrupted, and a monitor that completed it."""
    for _ in range(2):  # the second time, the objects cached by the specification exist
        monitor, strike = _begun(spec), _Strike()
        _struck(monitor, strike)
    return [*strike.passed], monitor


def _interrupted(spec: rvmon.Spec, places: list[Place]) -> Iterator[Monitor]:
    """For each place a monitor whose step was interrupted there."""
    for place in places:
        monitor = _begun(spec)
        with pytest.raises(KeyboardInterrupt):
            _struck(monitor, _Strike(place))
        yield monitor


def _judged_on(monitor: Monitor) -> Report:
    """The verdicts of unaffected requirements when the run continues."""
    monitor.step_ns(4 * _S, {"x": 1.0, "y": 1.0})
    monitor.step_ns(5 * _S, {"y": 4.0, "f": True})
    assert "R4" in {one.requirement for one in monitor.open}
    assert monitor.next_due is not None
    monitor.step_ns(5 * _S + 1, {"y": 1.0, "e": True})
    monitor.step_ns(5 * _S + 2, {"q": True})
    monitor.advance_ns(6 * _S)
    monitor.step_ns(6 * _S, {"x": 4.0, "f": True, "p": True})
    report = monitor.finish_ns(8 * _S)
    assert report.verdicts["R3"] == report.verdicts["R4"] == "F"
    return report


def _untouched(report: Report) -> list[Attempt]:
    return [one for one in report.attempts if one.requirement in ("R3", "R4")]


def _is_torn(report: Report) -> bool:
    return any(one.kind is HealthKind.INTERRUPTED for one in report.health)


def test_after_an_interrupted_step_nothing_passes_and_the_monitor_continues() -> None:
    """A step is judged in full, or not at all, or what has not failed is inconclusive.

    What goes on from a snapshot judges the other requirements as if nothing had been; the terminal
    names the instant, and JUnit skips.
    """
    spec = rvmon.loads(_SPEC)
    skipped = _begun(spec).finish_ns(3 * _S + 1)
    whole = _passed(spec)[1].finish_ns(3 * _S + 1)
    places, monitor = _passed(spec)
    expected = _untouched(_judged_on(monitor))
    assert (skipped.verdicts["R1"], whole.verdicts["R1"]) == ("P", "F")
    assert len(places) > 50
    torn, lines = 0, set()
    for monitor in _interrupted(spec, places):
        verdicts, other = monitor.verdicts, spec.restore(monitor.snapshot())
        assert other.verdicts == verdicts
        assert _untouched(_judged_on(other)) == expected
        report = monitor.finish_ns(3 * _S + 1)
        assert Report.from_json(report.to_json()).verdicts == report.verdicts
        if _is_torn(report):
            assert {*verdicts.values(), *report.verdicts.values()} <= {"F", "I"}
        else:
            assert report in (skipped, whole)
        torn += _is_torn(report)
        facts = health_facts(report.health, report.origin)
        found = [f"{names}  {fact}" for names, fact in facts if "interrupted" in fact]
        assert bool(found) is ("was not evaluated in full" in junit_xml([report], spec.checked))
        lines |= {line.partition(":")[0] for line in found}
        monitor.reset()
        monitor.step_ns(0, {"x": 1.0})
        assert monitor.finish_ns(1).verdicts["R1"] == "P"
    assert torn > len(places) / 3
    assert "monitor  interrupted once, first at 1 s (stamp 2 s)" in lines


def test_what_a_sample_raises_itself_tears_nothing() -> None:
    class Broken(dict[str, object]):
        def items(self) -> Any:
            raise LookupError("no such field")

    monitor = rvmon.loads(_SPEC).monitor()
    monitor.step_ns(0, {"x": 1.0})
    with pytest.raises(LookupError):
        monitor.step_ns(1, Broken(x=4.0))
    assert monitor.finish_ns(2).verdicts["R1"] == "P"
