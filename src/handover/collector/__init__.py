"""The coverage collector: which of the robot's statements and transitions the tests reach."""
