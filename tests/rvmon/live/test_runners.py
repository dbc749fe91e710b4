"""Live monitors in their own thread or in an event loop, with samples from other threads."""

import asyncio
import threading
import time

from rvmon import Verdict, loads
from rvmon.live import Driver, Live, LiveTasks

SPEC = """
spec s
signal x : real
event a, b
requirement R1
  always x <= 1
requirement R2
  upon a
  then within 20 ms b
"""
LONG = 30.0
"""Seconds after which waiting fails."""


def test_a_deadline_passes_in_real_time_without_samples():
    failed = threading.Event()
    with Live(loads(SPEC), on_failure=lambda _: failed.set()) as live:
        live.offer({"a": True})
        assert failed.wait(LONG)


def test_calls_within_one_step_of_a_coarse_clock_keep_their_order(monkeypatch):
    monkeypatch.setattr(time, "monotonic_ns", lambda: 7)
    driver = Driver(loads(SPEC))
    driver.offer({"a": True, "x": 0.5})
    driver.offer({"a": True})
    driver.lose(["x"])
    driver.offer({"a": True})
    driver.found(["x"])
    driver.offer({"b": True, "x": 0.5})
    (report,) = driver.close()[""]
    answered = [attempt for attempt in report.attempts if attempt.requirement == "R2"]
    found = [(attempt.triggered, attempt.decided) for attempt in answered]
    assert found == [(0, 5), (1, 5), (3, 5)]
    assert [entry.first for entry in report.health] == [2]


def test_threads_that_wait_for_room_lose_no_sample():
    with Live(loads(SPEC), room=3) as live:
        threads = [
            threading.Thread(target=lambda: [live.offer({"x": 0.5}, wait=True) for _ in range(500)])
            for _ in range(4)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(LONG)
    status = live.status()[""]
    assert (status.samples, status.lost, status.refusal) == (2000, 0, "")
    assert live.close()[""][0].verdicts["R1"] is Verdict.PASS


def test_a_callback_cannot_close_the_monitor():
    """It runs in the thread that would have to end."""
    told = threading.Event()
    live = Live(loads(SPEC), on_failure=lambda _: (told.set(), live.close()))
    with live:
        live.offer({"x": 2.0})
        assert told.wait(LONG)
    assert live.errors == 1


def test_samples_lost_to_a_slow_callback_are_counted_and_leave_verdicts_open():
    goes_on = threading.Event()
    spec = loads(SPEC.replace("20 ms", "2 s"))
    with Live(spec, room=10, on_failure=lambda _: goes_on.wait(LONG)) as live:
        live.offer({"x": 0.0})
        live.offer({"x": 2.0})  # its failure keeps the callback busy
        taken = sum(live.offer({"x": 0.0, "a": True}) for _ in range(50))
        goes_on.set()
    status = live.status()[""]
    assert taken < 50
    assert (status.samples, status.lost) == (2 + taken, 50 - taken)
    assert status.verdicts == {"R1": Verdict.FAIL, "R2": Verdict.INCONCLUSIVE}


def test_a_deadline_passes_in_the_loop():
    async def main():
        failed = asyncio.Event()
        threads = []

        def hear(_):
            threads.append(threading.current_thread())
            failed.set()

        async with LiveTasks(loads(SPEC), on_failure=hear) as live:
            live.offer({"a": True})
            await asyncio.wait_for(failed.wait(), 30)
        assert threads == [threading.current_thread()]

    asyncio.run(main())


def test_samples_from_other_threads_are_evaluated_even_if_the_body_raises():
    async def main():
        try:
            async with LiveTasks(loads(SPEC)) as live:
                await asyncio.to_thread(live.offer, {"a": True, "b": True})
                live.offer({"a": True, "b": True})
                raise KeyError
        except KeyError:
            return live.close()

    (report,) = asyncio.run(main())[""]
    assert report.counts["R2"][Verdict.PASS] == 2
