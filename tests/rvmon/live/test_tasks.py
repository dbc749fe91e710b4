"""Live monitors in an event loop."""

import asyncio
import threading

from rvmon import Verdict, loads
from rvmon.live import LiveTasks

SPEC = "spec s\nevent a, b\nrequirement R\n  upon a\n  then within 20 ms b\n"


def test_a_deadline_passes_in_the_loop():
    """The callback is called in the thread of the loop, while a task sleeps."""

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
        return live.close()

    assert asyncio.run(main())[""][0].verdicts["R"] is Verdict.FAIL


def test_samples_may_come_from_other_threads():
    """They are judged in the loop."""

    async def main():
        async with LiveTasks(loads(SPEC)) as live:
            await asyncio.to_thread(live.offer, {"a": True, "b": True})
        return live.close()

    assert asyncio.run(main())[""][0].verdicts["R"] is Verdict.PASS


def test_leaving_judges_what_waits():
    """Also what was offered in the last moment, and where the body raised."""

    async def main():
        try:
            async with LiveTasks(loads(SPEC)) as live:
                live.offer({"a": True, "b": True})
                raise KeyError
        except KeyError:
            return live.close()

    assert asyncio.run(main())[""][0].verdicts["R"] is Verdict.PASS
