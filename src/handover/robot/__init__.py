"""The code under test: the robot's side of the handover, written like code of a real robot."""
