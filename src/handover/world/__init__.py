"""The simulated world: scene, arm, human body, sensors, message bus and simulated time."""
