"""A monitor takes one call at a time, from any thread, and refuses others with an error."""

import signal
import threading
from itertools import count

import pytest

import rvmon
from rvmon.errors import OverlapError
from rvmon.monitor.monitor import Monitor

_SPEC = """spec s
signal x : real
event e
event p
requirement R1
  always x <= 3
requirement R2
  upon e
  then within 1 s p
"""


def _monitor() -> Monitor:
    return rvmon.loads(_SPEC).monitor()


class _Odd(dict[str, object]):
    """A sample that needs the slow way."""


def _tried(monitor: Monitor, number: int, found: list[str], *, odd: bool = False) -> None:
    """Take a step and record its result: appending is atomic, counting is not."""
    row = {"x": float(number % 5), "e": True, "p": number % 3 == 0}
    try:
        monitor.step_ns(number, _Odd(row) if odd and number % 2 else row)
    except Exception as error:  # noqa: BLE001 - whatever comes is looked at
        found.append(type(error).__name__)
    else:
        found.append("taken")


def _numbers(monitor: Monitor, end: int, found: list[str]) -> list[int]:
    """The numbers of R2's attempts; each sample was taken or refused with an error."""
    assert set(found) <= {"taken", "OverlapError", "TimeOrderError"}
    report = monitor.finish_ns(end)
    numbers = [one.number for one in report.attempts if one.requirement == "R2"]
    assert len(numbers) <= found.count("taken")
    return numbers


@pytest.mark.usefixtures("quick_turns")
@pytest.mark.parametrize("odd", [False, True])
def test_two_threads_affect_only_their_own_calls(odd: bool) -> None:
    """Every second sample may need the slow way."""
    monitor, clock, found = _monitor(), count(1), list[str]()

    def work() -> None:
        for _ in range(600):
            _tried(monitor, next(clock), found, odd=odd)

    workers = [threading.Thread(target=work) for _ in range(2)]
    for one in workers:
        one.start()
    for one in workers:
        one.join()
    numbers = _numbers(monitor, next(clock), found)
    assert sorted(numbers) == list(range(1, len(numbers) + 1))


def test_a_call_within_another_is_refused() -> None:
    monitor = _monitor()
    refused = []

    class Values(dict[str, object]):
        def items(self):  # type: ignore[no-untyped-def]
            for call in (
                lambda: monitor.step_ns(5, {"x": 1.0}),
                lambda: monitor.step(5.0, {"x": 1.0}),
                lambda: monitor.advance_ns(5),
                lambda: monitor.finish_ns(5),
                lambda: monitor.open,
                lambda: monitor.verdicts,
                lambda: monitor.next_due,
                lambda: monitor.snapshot(),
                monitor.reset,
            ):
                with pytest.raises(OverlapError, match="lock around the calls"):
                    call()
                refused.append(call)
            return super().items()

    monitor.step_ns(1, {"x": 1.0})
    monitor.step_ns(2, Values(x=4.0))
    assert len(refused) >= 9
    assert monitor.finish_ns(3).verdicts["R1"] == "F"


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there is no signal.setitimer")
def test_a_signal_handler_within_a_step_is_refused_or_takes_its_sample_whole() -> None:
    monitor, clock, found = _monitor(), count(1), list[str]()

    def step(*_: object) -> None:
        _tried(monitor, next(clock), found)

    before = signal.signal(signal.SIGALRM, step)
    signal.setitimer(signal.ITIMER_REAL, 0.0005, 0.0005)
    try:
        for _ in range(2000):
            step()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert max(_numbers(monitor, next(clock), found)) <= found.count("taken")


def test_callbacks_may_call_their_monitor() -> None:
    monitor = _monitor()
    looked = []

    def look(attempt: rvmon.Attempt) -> None:
        looked.append((attempt.name, monitor.verdicts["R1"], len(monitor.open), monitor.next_due))
        assert rvmon.loads(_SPEC).restore(monitor.snapshot()).open == monitor.open
        if len(looked) == 1:
            monitor.step_ns(3, {"x": 1.0})

    monitor.on_failure(look)
    monitor.step_ns(1, {"x": 1.0})
    monitor.step_ns(2, {"x": 4.0})
    monitor.step_ns(4, {"x": 5.0})
    assert [name for name, *_ in looked] == ["R1#1", "R1#2"]
    assert monitor.finish_ns(5).counts["R1"]["F"] == 2
