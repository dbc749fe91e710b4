"""The coverage collector: which of the robot's statements and transitions are to be reached."""
