"""Monitoring of running robots: clocks, timers, bounded queues, threads and tasks.

`driver` passes samples of any number of robots to their monitors and advances their time; it starts
no thread and never sleeps. `runners` call it, in a thread of its own or in an event loop. Adapters
for middleware only call `offer`.
"""

from rvmon.live.clock import Clock, SimulatedClock, WallClock
from rvmon.live.driver import Driver
from rvmon.live.durable import DurableMonitor
from rvmon.live.function_calls import as_event
from rvmon.live.robot import Judgement, Status
from rvmon.live.runners import Live, LiveTasks

__all__ = [
    "Clock",
    "Driver",
    "DurableMonitor",
    "Judgement",
    "Live",
    "LiveTasks",
    "SimulatedClock",
    "Status",
    "WallClock",
    "as_event",
]
