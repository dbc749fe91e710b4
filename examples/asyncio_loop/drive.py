"""A controller in an event loop: if the monitor reports that the base does not stop, it brakes."""

import asyncio
from pathlib import Path

import rvmon
from rvmon.live import LiveTasks

SPEC = Path(__file__).parents[1] / "base.rv"


class Base:
    """A base with a broken brake."""

    speed = 0.8

    def brake(self):
        """Do nothing."""

    def emergency_stop(self):
        self.speed = 0.0


async def main():
    base, failed = Base(), asyncio.Event()
    async with LiveTasks(rvmon.load(SPEC), only=["B2"], on_failure=lambda _: failed.set()) as live:
        live.offer({"speed": base.speed, "obstacle": 2.0})
        live.offer({"stop_request": True})
        base.brake()
        await failed.wait()  # no sample comes: the deadline decides
        base.emergency_stop()
        live.offer({"speed": base.speed})
    (report,) = live.close()[""]
    for attempt in report.attempts:
        print(attempt.name, attempt.verdict, attempt.reason)


if __name__ == "__main__":
    asyncio.run(main())
