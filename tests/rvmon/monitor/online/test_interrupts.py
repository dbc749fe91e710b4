"""After Ctrl-C, wherever it comes within a step, a monitor goes on."""

import dis
import sys
from types import CodeType, FrameType
from typing import Any

import pytest

import rvmon
from rvmon.monitor.online.monitor import Monitor
from rvmon.verdict.attempt import Attempt

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


class _Strike:
    """A trace function that interrupts rvmon once, where a signal handler may run.

    Python looks for signals as a function of its own begins, behind a call, and on the way back in
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
        ours = "rvmon" in code.co_filename or code.co_filename == "<generated monitor>"
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


def _begun(spec: rvmon.Spec, engine: str) -> Monitor:
    monitor = spec.monitor(engine=engine)
    monitor.step_ns(1 * _S, {"x": 1.0, "y": 1.0, "e": False, "p": False, "f": True, "q": False})
    monitor.step_ns(2 * _S, {"x": 1.0, "y": 4.0, "e": True, "p": False, "f": False, "q": True})
    return monitor


def _struck(monitor: Monitor, strike: _Strike) -> None:
    """A step in which R1 fails, an attempt of R2 begins and one ends; it concerns no other."""
    before = sys.gettrace()
    sys.settrace(strike)
    try:
        monitor.step_ns(3 * _S, {"x": 4.0, "e": True, "p": True})
    finally:
        sys.settrace(before)


def _judged_on(monitor: Monitor) -> list[Attempt]:
    """What comes of the requirements that the step did not concern, when the run goes on."""
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
    return [one for one in report.attempts if one.requirement in ("R3", "R4")]


@pytest.mark.parametrize("engine", ["auto", "automaton", "network", "progression"])
def test_an_interrupt_leaves_the_monitor_open(engine: str) -> None:
    """Whatever place of the code it strikes, later calls are taken, and judged right."""
    spec = rvmon.loads(_SPEC)
    for _ in range(2):  # the second time what a specification keeps for its monitors is there
        whole = _Strike()
        monitor = _begun(spec, engine)
        _struck(monitor, whole)
        expected = _judged_on(monitor)
    assert len(whole.passed) > 50
    for place in whole.passed:
        monitor = _begun(spec, engine)
        with pytest.raises(KeyboardInterrupt):
            _struck(monitor, _Strike(place))
        assert _judged_on(monitor) == expected
