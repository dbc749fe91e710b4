"""A ROS 1 node of a base that comes too near and does not stop on request."""

import rospy
from std_msgs.msg import Empty, Float64

rospy.init_node("base")
speed = rospy.Publisher("/speed", Float64, queue_size=10)
obstacle = rospy.Publisher("/obstacle", Float64, queue_size=10)
stop_request = rospy.Publisher("/stop_request", Empty, queue_size=10)
while not all(topic.get_num_connections() for topic in (speed, obstacle, stop_request)):
    rospy.sleep(0.05)  # wait for the subscriber
speed.publish(0.8)
for metres in (2.0, 1.0, 0.4):
    obstacle.publish(metres)
    rospy.sleep(0.1)
stop_request.publish()
rospy.sleep(1.0)
