"""Time, samples and recordings: the input of monitors, and the schema of its names."""
