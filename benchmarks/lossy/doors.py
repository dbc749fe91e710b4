"""All doors at which something can be lost, by name."""

from __future__ import annotations

from benchmarks.lossy import dds, files, live, ros1, wires
from benchmarks.lossy.trial import Door
from tests.tools.servers import mosquitto, rosmaster

from rvmon.testing.generate.trace import TraceProfile

TOPICS = TraceProfile(advances=False, unknowns=False)
"""Fields of messages have a value."""

DOORS = {
    "csv": files.CSV,
    "json lines": files.JSON_LINES,
    "parquet": files.PARQUET,
    "mcap": files.MCAP,
    "stdin": Door(live.stdin),
    "live": Door(live.live),
    "durable": Door(live.durable),
    "mqtt": Door(wires.through_mqtt),
    "dds": Door(dds.through_dds, TOPICS, plain=True),
    "ros1": Door(ros1.through_ros1, TOPICS, plain=True),
}

SERVERS = {"mqtt": ("mosquitto", mosquitto), "ros1": ("rosmaster, or rospy", rosmaster)}
"""By door, the program that it needs, and how it is found."""
