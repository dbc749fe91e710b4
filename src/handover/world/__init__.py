"""The simulated world: scene, arm, human body, sensing, message bus and the loop of time."""
