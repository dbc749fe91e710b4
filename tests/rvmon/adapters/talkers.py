"""A simulator as a node of ROS 1: a process of its own, with `use_sim_time`."""

SIMULATOR = """
import time
import rospy
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Bool, Float64
rospy.init_node("simulator")
speed = rospy.Publisher("/speed", Float64, queue_size=10, latch=True)
obstacle = rospy.Publisher("/obstacle", Float64, queue_size=10, latch=True)
stop_request = rospy.Publisher("/stop_request", Bool, queue_size=10)
clock = rospy.Publisher("/clock", Clock, queue_size=10)
speed.publish(0.8)
obstacle.publish(0.4)
while not stop_request.get_num_connections():
    clock.publish(rospy.Time(1000))
    time.sleep(0.02)
clock.publish(rospy.Time(2000))
time.sleep(0.1)
stop_request.publish(True)
while not rospy.is_shutdown():
    time.sleep(0.1)
    clock.publish(rospy.Time(2001))
"""
