"""Programs that publish a speed and a stop request, each as a process of its own."""

ROS1 = """
import rospy
from std_msgs.msg import Bool, Float64
rospy.init_node("talker")
speed = rospy.Publisher("/base/speed", Float64, queue_size=10)
stop = rospy.Publisher("/stop", Bool, queue_size=10)
while not (speed.get_num_connections() and stop.get_num_connections()):
    rospy.sleep(0.02)
for value in (0.5, 1.5, 0.3):
    speed.publish(value)
    rospy.sleep(0.02)
stop.publish(True)
rospy.spin()
"""

DDS = """
import sys, time
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

here = DomainParticipant(int(sys.argv[1]))
qos = Qos(Policy.Reliability.Reliable(10**9), Policy.History.KeepLast(10))
speed = DataWriter(here, Topic(here, "rt/base/speed", Float64), qos=qos)
stop = DataWriter(here, Topic(here, "rt/stop", Bool), qos=qos)
while not (speed.get_matched_subscriptions() and stop.get_matched_subscriptions()):
    time.sleep(0.02)
for value in (0.5, 1.5, 0.3):
    speed.write(Float64(value))
    time.sleep(0.02)
stop.write(Bool(True))
time.sleep(60)
"""

SIMULATOR = """
import time
import rospy
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Bool, Float64
rospy.init_node("simulator")
speed = rospy.Publisher("/base/speed", Float64, queue_size=10, latch=True)
stop = rospy.Publisher("/stop", Bool, queue_size=10)
clock = rospy.Publisher("/clock", Clock, queue_size=10)
speed.publish(1.5)
while not stop.get_num_connections():
    clock.publish(rospy.Time(1000))
    time.sleep(0.02)
clock.publish(rospy.Time(2000))
time.sleep(0.1)
stop.publish(True)
while not rospy.is_shutdown():
    time.sleep(0.1)
    clock.publish(rospy.Time(2001))
"""
