"""Live monitors in a thread of their own, offered samples from others, and in an event loop."""

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
"""Seconds after which a test that waits has failed."""


def test_a_deadline_passes_in_real_time_without_samples():
    failed = threading.Event()
    with Live(loads(SPEC), on_failure=lambda _: failed.set()) as live:
        live.offer({"a": True})
        assert failed.wait(LONG)


def test_a_wall_clock_that_is_coarse_gives_each_report_an_instant_of_its_own(monkeypatch):
    """What was offered, lost and found within one of its steps keeps its order."""
    monkeypatch.setattr(time, "monotonic_ns", lambda: 7)
    driver = Driver(loads(SPEC))
    driver.offer({"a": True, "x": 0.5})
    driver.offer({"a": True})
    driver.lose(["x"])
    driver.offer({"a": True})
    driver.found(["x"])
    driver.offer({"b": True, "x": 0.5})
    (report,) = driver.close()[""]
    answered = [one for one in report.attempts if one.requirement == "R2"]
    assert [(one.triggered, one.decided) for one in answered] == [(0, 5), (1, 5), (3, 5)]
    assert [one.first for one in report.health] == [2]


def test_samples_of_many_threads_are_all_judged():
    """Who waits for room loses nothing."""
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


def test_a_callback_that_closes_is_refused_and_nothing_hangs():
    """It runs in the thread that would have to end."""
    told = threading.Event()
    live = Live(loads(SPEC), on_failure=lambda _: (told.set(), live.close()))
    with live:
        live.offer({"x": 2.0})
        assert told.wait(LONG)
    assert live.errors == 1


def test_a_slow_callback_costs_samples_that_are_counted():
    """And no verdict that needs them; who offers is never held up."""
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


def test_samples_may_come_from_other_threads_up_to_the_last_moment():
    """They are judged in the loop, also where the body raised."""

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
