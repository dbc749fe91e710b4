"""Recordings of messages: bags of ROS 1 and ROS 2, MCAP files."""
