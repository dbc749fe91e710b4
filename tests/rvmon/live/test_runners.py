"""Live monitors in a thread of their own, offered samples from others, and in an event loop."""

import asyncio
import threading

from rvmon import Verdict, loads
from rvmon.live import Live, LiveTasks, SimulatedClock

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
    """The thread wakes by itself."""
    failed = threading.Event()
    with Live(loads(SPEC), on_failure=lambda _: failed.set()) as live:
        live.offer({"a": True})
        assert failed.wait(LONG)


def test_samples_of_many_threads_are_all_judged():
    """Stamps given here increase, whoever offers."""
    with Live(loads(SPEC), room=100) as live:
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


def test_who_waits_for_room_loses_nothing():
    """A reader of a file is held up instead."""
    with Live(loads(SPEC), room=1, clock=SimulatedClock()) as live:
        for t in range(300):
            assert live.offer({"x": float(t == 299) * 2}, t_ns=t, wait=True)
    assert live.status()[""].samples == 300
    assert live.close()[""][0].verdicts["R1"] is Verdict.FAIL


def test_a_callback_that_closes_is_refused_and_nothing_hangs():
    """It runs in the thread that would have to end."""
    told = threading.Event()
    live = Live(loads(SPEC), on_failure=lambda _: (told.set(), live.close()))
    with live:
        live.offer({"x": 2.0})
        assert told.wait(LONG)
    assert live.errors == 1


IN_THE_LOOP = "spec s\nevent a, b\nrequirement R\n  upon a\n  then within 20 ms b\n"


def test_a_deadline_passes_in_the_loop():
    """The callback is called in the thread of the loop, while a task sleeps."""

    async def main():
        failed = asyncio.Event()
        threads = []

        def hear(_):
            threads.append(threading.current_thread())
            failed.set()

        async with LiveTasks(loads(IN_THE_LOOP), on_failure=hear) as live:
            live.offer({"a": True})
            await asyncio.wait_for(failed.wait(), 30)
        assert threads == [threading.current_thread()]
        return live.close()

    assert asyncio.run(main())[""][0].verdicts["R"] is Verdict.FAIL


def test_samples_may_come_from_other_threads():
    """They are judged in the loop."""

    async def main():
        async with LiveTasks(loads(IN_THE_LOOP)) as live:
            await asyncio.to_thread(live.offer, {"a": True, "b": True})
        return live.close()

    assert asyncio.run(main())[""][0].verdicts["R"] is Verdict.PASS


def test_leaving_judges_what_waits():
    """Also what was offered in the last moment, and where the body raised."""

    async def main():
        try:
            async with LiveTasks(loads(IN_THE_LOOP)) as live:
                live.offer({"a": True, "b": True})
                raise KeyError
        except KeyError:
            return live.close()

    assert asyncio.run(main())[""][0].verdicts["R"] is Verdict.PASS
