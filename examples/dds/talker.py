"""A base that comes too near and does not stop on request, in the ROS 2 wire format without ROS."""

import sys
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic


@dataclass
class Float64(IdlStruct, typename="std_msgs::msg::dds_::Float64_"):
    data: float64


@dataclass
class Bool(IdlStruct, typename="std_msgs::msg::dds_::Bool_"):
    data: bool


def published(here, name, kind):
    qos = Qos(Policy.Reliability.Reliable(10**9), Policy.History.KeepLast(10))
    return DataWriter(here, Topic(here, f"rt/{name}", kind), qos=qos)


def main():
    here = DomainParticipant(int(sys.argv[1]))
    speed, obstacle = published(here, "speed", Float64), published(here, "obstacle", Float64)
    stop_request = published(here, "stop_request", Bool)
    while not all(topic.get_matched_subscriptions() for topic in (speed, obstacle, stop_request)):
        time.sleep(0.05)  # wait for the subscriber
    speed.write(Float64(0.8))
    for metres in (2.0, 1.0, 0.4):
        obstacle.write(Float64(metres))
        time.sleep(0.1)
    stop_request.write(Bool(True))
    time.sleep(1.0)


if __name__ == "__main__":
    main()
