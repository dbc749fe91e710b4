"""Watches of live doors whose process is killed at random points: does one pass over a message?"""

from __future__ import annotations

import itertools
import json
import os
import random
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.tools.forked import Forked
from tests.tools.servers import LOOPBACK, SYSTEM, Broker, master_of_ros1

from rvmon.cli import main

_SPEC = """
spec heard
signal id : int
requirement R
  upon updated(id) and delta(id) >= 0
  then delta(id) == 1
"""
"""Each message is an attempt, which fails if the one before it was lost, or comes twice."""

_EACH = 0.004
"""Seconds between two messages."""


@contextmanager
def _published(door: str, where: str) -> Iterator[None]:
    """Numbers from 0 on, by a process of its own, as long as the context lasts."""
    words = [sys.executable, "-m", "benchmarks.endurance.killed_doors", door, where]
    with subprocess.Popen(words, stderr=subprocess.DEVNULL) as process:
        try:
            yield
        finally:
            process.kill()


@contextmanager
def _mqtt(folder: Path) -> Iterator[str]:
    broker = Broker(folder)
    try:
        with _published("mqtt", str(broker.port)):
            yield f"mqtt://127.0.0.1:{broker.port}/r"
    finally:
        broker.stop()


@contextmanager
def _dds(_: Path) -> Iterator[str]:
    os.environ["CYCLONEDDS_URI"] = LOOPBACK
    domain = str(100 + os.getpid() % 100)
    with _published("dds", domain):
        yield f"dds:{domain}"


@contextmanager
def _ros1(folder: Path) -> Iterator[str]:
    sys.path.append(SYSTEM)
    with master_of_ros1() as address:
        os.environ |= {"ROS_MASTER_URI": address, "ROS_IP": "127.0.0.1", "ROS_HOME": str(folder)}
        with _published("ros1", ""):
            yield "ros1:"


DOORS = {"mqtt": _mqtt, "dds": _dds, "ros1": _ros1}


def killed(door: str, folder: Path, kills: int, seed: int) -> Counter[str]:
    """What became of so many watches, each killed when it has told a random number of verdicts.

    Args:
        door: one of `DOORS`.
        folder: for files.
        kills: so many watches.
        seed: of when they are killed.
    """
    rng, found = random.Random(seed), Counter[str]()
    (folder / "heard.rv").write_text(_SPEC)
    with DOORS[door](folder) as source:
        words = ["watch", "heard.rv", source, "--format", "json"]
        words += [] if door == "mqtt" else ["--map", "id=/id"]
        for _ in range(kills):
            process = Forked(lambda: main(words), folder, folder / "out")
            after = rng.randrange(1, 40)
            if not process.kill_behind(200 * after):
                found["ended by itself"] += 1
            told = [json.loads(line) for line in process.lines()]
            numbers = [one["attempt"] for one in told]
            found["kills"] += 1
            found["verdicts"] += len(told)
            found["lost"] += sum(one["verdict"] != "P" for one in told)
            found["told twice"] += len(numbers) - len({*numbers})
            found["left out"] += numbers != [f"R#{n}" for n in range(1, len(told) + 1)]
    return found


def main_of_publisher(door: str, where: str) -> None:
    send = {"mqtt": _send_mqtt, "dds": _send_dds, "ros1": _send_ros1}[door](where)
    for number in itertools.count():
        send(number)
        time.sleep(_EACH)


def _send_mqtt(port: str) -> Callable[[int], object]:
    from paho.mqtt.client import Client
    from paho.mqtt.enums import CallbackAPIVersion

    client = Client(CallbackAPIVersion.VERSION2)
    client.connect("127.0.0.1", int(port))
    client.loop_start()
    return lambda number: client.publish("r", json.dumps({"id": number}))


def _send_dds(domain: str) -> Callable[[int], object]:
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic

    from rvmon.adapters.dds import _idl_type

    kind = _idl_type("std_msgs/msg/Int64", ())
    participant = DomainParticipant(int(domain))
    writer = DataWriter(participant, Topic(participant, "rt/id", kind))
    return lambda number: writer.write(kind(data=number))


def _send_ros1(_: str) -> Callable[[int], object]:
    sys.path.append(SYSTEM)
    import rospy
    from std_msgs.msg import Int64

    rospy.init_node("robot")
    publisher = rospy.Publisher("/id", Int64, queue_size=10_000)
    return lambda number: publisher.publish(Int64(number))


if __name__ == "__main__":
    main_of_publisher(sys.argv[1], sys.argv[2])
