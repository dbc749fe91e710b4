"""Time and samples: what a monitor is fed with."""
