"""The coverage collector: the robot's statements and transitions that tests should cover."""
