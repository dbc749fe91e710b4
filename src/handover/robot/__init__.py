"""The code under test: the robot's side of the handover, written as for a real robot."""
