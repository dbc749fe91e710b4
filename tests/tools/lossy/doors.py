"""All doors at which something can be lost, by name."""

from __future__ import annotations

from tests.tools.lossy import files, live, wires
from tests.tools.lossy.trial import Door
from tests.tools.servers import mosquitto

DOORS = {
    "csv": files.CSV,
    "json lines": files.JSON_LINES,
    "parquet": files.PARQUET,
    "mcap": files.MCAP,
    "stdin": Door(live.stdin),
    "live": Door(live.live),
    "durable": Door(live.durable),
    "mqtt": Door(wires.through_mqtt, at_once=25),
}

SERVERS = {"mqtt": ("mosquitto", mosquitto)}
"""By door, the program that it needs, and how it is found."""
