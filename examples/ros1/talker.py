"""A base that comes too near, and does not stop when it is asked to: a node of ROS 1."""

import rospy
from std_msgs.msg import Empty, Float64

rospy.init_node("base")
speed = rospy.Publisher("/speed", Float64, queue_size=10)
obstacle = rospy.Publisher("/obstacle", Float64, queue_size=10)
stop_request = rospy.Publisher("/stop_request", Empty, queue_size=10)
while not all(topic.get_num_connections() for topic in (speed, obstacle, stop_request)):
    rospy.sleep(0.05)  # nobody listens yet
speed.publish(0.8)
for metres in (2.0, 1.0, 0.4):
    obstacle.publish(metres)
    rospy.sleep(0.1)
stop_request.publish()
rospy.sleep(1.0)
