"""Monitor a stream in another program: ten lines around one `step`."""

import csv
from pathlib import Path

import rvmon

HERE = Path(__file__).parent

spec = rvmon.load(HERE / "base.rv")
monitor = spec.monitor()
with open(HERE / "base.csv", newline="", encoding="utf-8") as file:
    for row in csv.DictReader(file):  # in place of a callback of the robot's middleware
        values = {"speed": float(row["speed"]), "obstacle": float(row["obstacle"])}
        if row["stop_request"]:
            values["stop_request"] = True
        for attempt in monitor.step(float(row["t"]), values):
            print(attempt)
for requirement, verdict in monitor.finish().verdicts.items():
    print(requirement, verdict)
